//! What surfaces of outputs show: cut faces of results, and normals.

use std::borrow::Cow;

use trisect::{CutFaces, FaceGroup, Material, Mesh, Solid};

/// Which normals outputs have.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Normals {
    /// Those of the inputs.
    #[default]
    Keep,
    /// Those of the faces.
    Flat,
    /// Smooth where faces meet at less than so many degrees.
    Angle(f64),
    /// None.
    None,
}

/// How texture coordinates are laid on cut faces, with so many of them to a unit of length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum CutUv {
    Planar(f64),
    Boxed(f64),
}

/// `keep`, `flat`, `none`, or an angle.
pub(crate) fn normals(text: &str) -> Result<Normals, String> {
    match text {
        "keep" => Ok(Normals::Keep),
        "flat" => Ok(Normals::Flat),
        "none" => Ok(Normals::None),
        angle => match angle.strip_prefix("angle:").unwrap_or(angle).parse::<f64>() {
            Ok(degrees) if (0.0..=180.0).contains(&degrees) => Ok(Normals::Angle(degrees)),
            _ => Err("expected keep, flat, none, or an angle from 0 to 180 degrees".into()),
        },
    }
}

/// `planar` or `box`, with `:` and how many to a unit of length.
pub(crate) fn cut_uv(text: &str) -> Result<CutUv, String> {
    let (kind, density) = text.split_once(':').unwrap_or((text, "1"));
    let density = density.parse::<f64>().ok().filter(|density| density.is_finite() && *density > 0.0);
    match (kind, density) {
        ("planar", Some(density)) => Ok(CutUv::Planar(density)),
        ("box", Some(density)) => Ok(CutUv::Boxed(density)),
        _ => {
            Err("expected planar or box, or with texture coordinates to a unit of length, as box:0.5".into())
        }
    }
}

/// `keep`, `body`, or a name.
pub(crate) fn cut_material(text: &str) -> Result<String, String> {
    match text.trim() {
        "" => Err("expected keep, body, or the name of a material".into()),
        name => Ok(name.to_owned()),
    }
}

/// What the cut faces show. A material's name means one of the operands, or else a new one.
pub(crate) fn cut_faces<'a>(
    material: Option<&str>,
    uv: Option<CutUv>,
    solids: impl Iterator<Item = &'a Solid>,
) -> CutFaces {
    let faces = match material {
        None | Some("keep") => CutFaces::tool(),
        Some("body") => CutFaces::body(),
        Some(name) => {
            let is_meant =
                |group: &&FaceGroup| group.material.as_ref().is_some_and(|material| material.name == name);
            let known = solids.flat_map(|solid| &solid.mesh().groups.list).find(is_meant).cloned();
            // Grey, as bare metal and plaster are.
            let new = || FaceGroup {
                name: name.to_owned(),
                material: Some(Material::plain(name, [0.5, 0.5, 0.5, 1.0])),
            };
            CutFaces::group(known.unwrap_or_else(new))
        }
    };
    match uv {
        None => faces,
        Some(CutUv::Planar(density)) => faces.planar(density),
        Some(CutUv::Boxed(density)) => faces.boxed(density),
    }
}

/// A mesh with the normals that the command line asks for.
pub(crate) fn shaded(mesh: Cow<'_, Mesh>, normals: Normals) -> Cow<'_, Mesh> {
    if normals == Normals::Keep {
        return mesh;
    }
    let mut mesh = mesh.into_owned();
    match normals {
        Normals::Keep => {}
        Normals::None => {
            mesh.attributes.retain(|attribute| !matches!(&*attribute.name, "NORMAL" | "TANGENT"));
        }
        Normals::Flat => {
            let normals = mesh.flat_normals();
            mesh.set_attribute(normals);
        }
        Normals::Angle(degrees) => {
            let normals = mesh.crease_normals(degrees);
            mesh.set_attribute(normals);
        }
    }
    Cow::Owned(mesh)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read() {
        assert_eq!(normals("angle:30"), Ok(Normals::Angle(30.0)));
        assert_eq!((normals("45"), normals("flat")), (Ok(Normals::Angle(45.0)), Ok(Normals::Flat)));
        assert_eq!((cut_uv("box"), cut_uv("planar:0.5")), (Ok(CutUv::Boxed(1.0)), Ok(CutUv::Planar(0.5))));
        for wrong in ["", "200", "-1", "nan", "smooth"] {
            assert!(normals(wrong).is_err(), "{wrong}");
        }
        for wrong in ["", "box:", "box:0", "box:-1", "box:inf", "sphere"] {
            assert!(cut_uv(wrong).is_err(), "{wrong}");
        }
    }
}
