//! Cages as JSON: all that a cage is, in one object.

use serde_json::{Map, Value, json};

use super::cage::{Cage, Scheme};
use super::details::{Details, DomainVertex};
use super::error::CageError;
use super::rules::Rules;
use super::tags::{Corner, Crease, INFINITE_SHARPNESS, Sector, Tags};
use crate::Error;

/// The keys of a cage.
const KEYS: [&str; 9] =
    ["kind", "positions", "faces", "creases", "corners", "sectors", "scheme", "rules", "details"];

/// Reads a cage from a JSON object.
pub(crate) fn read(bytes: &[u8]) -> Result<Cage, Error> {
    let value: Value = serde_json::from_slice(bytes).map_err(|error| {
        fault(&format!("line {}, column {}", error.line(), error.column()), "it is not JSON")
    })?;
    from_value(&value)
}

/// Reads a cage from a parsed JSON object.
pub(crate) fn from_value(value: &Value) -> Result<Cage, Error> {
    let object = value
        .as_object()
        .ok_or_else(|| fault("the whole", "a cage is an object with `positions` and `faces`"))?;
    if let Some(key) = object.keys().find(|key| !KEYS.contains(&key.as_str())) {
        let known = KEYS.join(", ");
        return Err(fault(key, &format!("there is no such key; known are {known}")).into());
    }
    let positions = lists(object, "positions", true)?;
    let faces = lists(object, "faces", true)?;
    let mut tags = Tags::default();
    for (at, row) in lists(object, "creases", false)?.iter().enumerate() {
        let [a, b, s] = row[..] else {
            return Err(wrong("creases", at, "[vertex, vertex, sharpness]").into());
        };
        tags.creases
            .push(Crease { edge: [index("creases", at, a)?, index("creases", at, b)?], sharpness: s });
    }
    for (at, row) in lists(object, "corners", false)?.iter().enumerate() {
        let [v, s] = row[..] else { return Err(wrong("corners", at, "[vertex, sharpness]").into()) };
        tags.corners.push(Corner { vertex: index("corners", at, v)?, sharpness: s });
    }
    for (at, row) in lists(object, "sectors", false)?.iter().enumerate() {
        let [v, first, angle, flatness] = row[..] else {
            return Err(wrong("sectors", at, "[vertex, first, angle, flatness]").into());
        };
        let (vertex, first) = (index("sectors", at, v)?, index("sectors", at, first)?);
        tags.sectors.push(Sector { vertex, first, angle, flatness });
    }
    let rules = match object.get("rules") {
        None => Rules::default(),
        Some(name) => name.as_str().and_then(Rules::named).ok_or_else(|| {
            fault("rules", &format!("they are one of {}", Rules::ALL.map(Rules::name).join(", ")))
        })?,
    };
    let mut points = Vec::with_capacity(positions.len());
    for (at, row) in positions.iter().enumerate() {
        let [x, y, z] = row[..] else { return Err(wrong("positions", at, "[x, y, z]").into()) };
        points.push([x, y, z]);
    }
    let scheme = match object.get("scheme") {
        None => None,
        Some(name) => Some(name.as_str().and_then(Scheme::named).ok_or_else(|| {
            fault("scheme", &format!("it is one of {}", Scheme::ALL.map(Scheme::name).join(", ")))
        })?),
    };
    let mut polygons = Vec::with_capacity(faces.len());
    for (at, row) in faces.iter().enumerate() {
        if row.len() < 3 || (row.len() > 3 && scheme == Some(Scheme::Loop)) {
            return Err(wrong("faces", at, "[vertex, vertex, vertex]").into());
        }
        polygons.push(row.iter().map(|&v| index("faces", at, v)).collect::<Result<_, CageError>>()?);
    }
    let details = details(object)?;
    let (cage, _) = Cage::new(points, &polygons, tags, rules, scheme)?;
    match cage {
        Cage::Loop(cage) => Ok(Cage::Loop(cage.with_details(details)?)),
        Cage::CatmullClark(_) if !details.is_empty() => {
            Err(fault("details", "they are of Loop's scheme: a cage of polygons has none").into())
        }
        polygons => Ok(polygons),
    }
}

/// The levels of details: each a list of [face, i, j, k, along, across, up].
fn details(object: &Map<String, Value>) -> Result<Vec<Details>, CageError> {
    let Some(value) = object.get("details") else { return Ok(Vec::new()) };
    let levels = value.as_array().ok_or_else(|| fault("details", "it is not a list of levels"))?;
    let mut all = Vec::new();
    for level in levels {
        let rows = lists(&Map::from_iter([("details".to_owned(), level.clone())]), "details", true)?;
        let mut at = Vec::new();
        for (n, row) in rows.iter().enumerate() {
            let [face, i, j, k, x, y, z] = row[..] else {
                return Err(wrong("details", n, "[face, i, j, k, along, across, up]"));
            };
            let whole = |value| index("details", n, value);
            let vertex = DomainVertex { face: whole(face)?, numerators: [whole(i)?, whole(j)?, whole(k)?] };
            at.push((vertex, [x, y, z]));
        }
        all.push(Details { at });
    }
    Ok(all)
}

fn fault(place: &str, what: &str) -> CageError {
    let place = place.chars().take(60).collect();
    CageError::File { place, what: what.into() }
}

fn wrong(key: &str, at: usize, form: &str) -> CageError {
    fault(&format!("{key}[{at}]"), &format!("it is not {form}"))
}

/// A list of lists of numbers.
fn lists(object: &Map<String, Value>, key: &str, needed: bool) -> Result<Vec<Vec<f64>>, CageError> {
    let Some(value) = object.get(key) else {
        return if needed { Err(fault(key, "it is missing")) } else { Ok(Vec::new()) };
    };
    let all = value.as_array().ok_or_else(|| fault(key, "it is not a list"))?;
    let row = |(at, row): (usize, &Value)| -> Result<Vec<f64>, CageError> {
        let row = row.as_array().ok_or_else(|| wrong(key, at, "a list of numbers"))?;
        row.iter().map(|x| x.as_f64().ok_or_else(|| wrong(key, at, "a list of numbers"))).collect()
    };
    all.iter().enumerate().map(row).collect()
}

fn index(key: &str, at: usize, value: f64) -> Result<u32, CageError> {
    if value >= 0.0 && value <= f64::from(u32::MAX) && value.fract() == 0.0 {
        return Ok(value as u32);
    }
    Err(wrong(key, at, "vertex numbers, from 0"))
}

/// A cage as one JSON object; reading it gives the same bits.
pub(crate) fn to_value(cage: &Cage) -> Value {
    let finite = |sharpness: f64| if sharpness.is_finite() { sharpness } else { INFINITE_SHARPNESS };
    let tags = cage.tags();
    let creases: Vec<Value> =
        tags.creases.iter().map(|c| json!([c.edge[0], c.edge[1], finite(c.sharpness)])).collect();
    let corners: Vec<Value> = tags.corners.iter().map(|c| json!([c.vertex, finite(c.sharpness)])).collect();
    let mut object = json!({
        "kind": "freeform",
        "positions": cage.positions(),
        "faces": cage.faces(),
        "creases": creases,
        "corners": corners,
    });
    let Cage::Loop(cage) = cage else {
        object["scheme"] = cage.scheme().name().into();
        return object;
    };
    object["rules"] = cage.rules().name().into();
    object["sectors"] =
        tags.sectors.iter().map(|s| json!([s.vertex, s.first, s.angle, s.flatness])).collect();
    let details: Vec<Vec<Value>> = cage
        .details()
        .iter()
        .map(|level| {
            let row = |(vertex, [x, y, z]): &(DomainVertex, [f64; 3])| {
                let [i, j, k] = vertex.numerators;
                json!([vertex.face, i, j, k, x, y, z])
            };
            level.at.iter().map(row).collect()
        })
        .collect();
    if !details.is_empty() {
        object["details"] = details.into();
    }
    object
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cage_survives_a_round_trip() {
        let text = br#"{"positions": [[0,0,1],[1,0,0.1],[0,1,0],[-1,-1,0]], "faces": [[0,1,2],[0,2,3],[0,3,1],[1,3,2]],
            "creases": [[0,1,2.5],[1,2,10]], "corners": [[3,10]], "rules": "biermann"}"#;
        let cage = read(text).expect("valid");
        let again = read(to_value(&cage).to_string().as_bytes()).expect("valid");
        assert_eq!(again.tags(), cage.tags());
        assert_eq!(again.positions(), cage.positions());
        assert_eq!(again.faces(), cage.faces());
        assert!(
            matches!((cage, again), (Cage::Loop(a), Cage::Loop(b)) if a.rules() == Rules::Biermann && b.rules() == a.rules())
        );
    }

    #[test]
    fn quads_are_of_catmull_and_clark_s_scheme() {
        let text =
            r#"{"positions": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]], "faces": [[0,1,2,3]], "corners": [[2,10]]}"#;
        let cage = read(text.as_bytes()).expect("valid");
        assert_eq!((cage.scheme(), cage.face_count()), (Scheme::CatmullClark, 1));
        let again = read(to_value(&cage).to_string().as_bytes()).expect("valid");
        assert_eq!((again.tags(), again.faces(), again.scheme()), (cage.tags(), cage.faces(), cage.scheme()));
        let with = |key: &str| {
            read(text.replacen('{', &format!("{{{key}, "), 1).as_bytes()).unwrap_err().to_string()
        };
        assert!(with(r#""scheme": "loop""#).contains("faces[0]"));
        assert!(with(r#""scheme": "doo-sabin""#).contains("catmull-clark"));
        assert!(with(r#""details": [[[0, 1, 1, 0, 0, 0, 1]]]"#).contains("polygons"));
        assert!(with(r#""sectors": [[2, 1, 4, 0.5]]"#).contains("sectors"));
    }

    #[test]
    fn hostile_objects_are_refused_with_the_key() {
        for (text, word) in [
            ("", "not JSON"),
            ("[]", "object"),
            ("{}", "positions"),
            (r#"{"positions": [], "faces": [[0, 1, 2]]}"#, "names vertex 0"),
            (r#"{"positions": [[0, 0]], "faces": []}"#, "positions[0]"),
            (r#"{"positions": [[0, 0, "x"]], "faces": []}"#, "positions[0]"),
            (r#"{"positions": [], "faces": [[0, 1.5, 2]]}"#, "faces[0]"),
            (r#"{"positions": [], "faces": [[0, 1, 4294967296]]}"#, "faces[0]"),
            (r#"{"positions": [], "faces": [], "creases": [[0, 1]]}"#, "creases[0]"),
            (r#"{"positions": [], "faces": [], "rules": "doo-sabin"}"#, "rules"),
            (r#"{"positions": [], "faces": [], "detials": []}"#, "detials"),
        ] {
            let error = read(text.as_bytes()).unwrap_err().to_string();
            assert!(error.contains(word), "{text}: {error}");
        }
    }
}
