//! Pages for browsers: `-o result.html`. What they look like is tried by hand, with `assets/viewer/check.sh`.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;
use trisect::io::{Format, ReadOptions, read};

use crate::common::program::{Folder, cube};

/// The text of an element of a page.
#[track_caller]
fn element<'a>(page: &'a str, id: &str) -> &'a str {
    let (_, rest) = page.split_once(&format!("id=\"{id}\">")).expect("the element");
    rest.split_once("</script>").expect("its end").0
}

fn workshop() -> Folder {
    let folder = Folder::new();
    folder.write("a.obj", cube([0.0; 3], [2.0; 3]));
    folder.write("b.obj", cube([1.0; 3], [3.0; 3]));
    folder
}

#[test]
fn a_page_holds_the_model_and_asks_for_nothing() {
    let folder = workshop();
    folder.run("difference a.obj b.obj -o result.html").exits(0).says("result.html");
    assert_eq!(folder.names(), ["a.obj", "b.obj", "result.html"]);
    let page = folder.read("result.html");
    // 1. Nothing is fetched: there is no address but those in the library's own text, which is packed.
    assert!(page.contains("default-src 'none'"), "not even by a model whose pictures have addresses");
    for word in ["src=", "href=", "http:", "https:", "@import", "url(", "{{"] {
        assert!(!page.contains(word), "{word}");
    }
    // 2. The model, with the input that each triangle comes from.
    let model = STANDARD.decode(element(&page, "model")).expect("base64");
    let mesh = read(&model, Format::Glb, &ReadOptions::new()).expect("a model").mesh;
    assert!((mesh.volume() - 7.0).abs() < 1e-6);
    let codes = mesh.attribute("_OPERAND").expect("where triangles come from");
    let mut found = codes.values.clone();
    found.sort_by(f64::total_cmp);
    found.dedup();
    // The first input as it is, and the second turned round.
    assert_eq!(found, [0.0, 3.0]);
    // 3. What is told.
    let data: Value = serde_json::from_str(element(&page, "data")).expect("JSON");
    let facts = data["facts"].as_array().expect("a list");
    let told = |name: &str| facts.iter().find(|fact| fact[0] == name).map(|fact| fact[1].clone());
    assert_eq!(told("volume"), Some("7".into()));
    assert_eq!((&data["way"], &data["up"]), (&"operand".into(), &serde_json::json!([0.0, 1.0, 0.0])));
    // 4. The library.
    let library = STANDARD.decode(element(&page, "library")).expect("base64");
    assert!(library.starts_with(b"\x1f\x8b") && library.len() > 100_000);
}

#[test]
fn names_do_not_end_elements() {
    let folder = workshop();
    folder.run("convert a.obj -o a<b&c.html").exits(0);
    let page = folder.read("a<b&c.html");
    assert!(page.contains("<title>a&lt;b&amp;c</title>"));
    let data: Value = serde_json::from_str(element(&page, "data")).expect("JSON");
    assert_eq!(data["way"], "material");
    assert_eq!(page.matches("</script>").count(), 4);
}

#[test]
fn a_page_is_an_output_as_others_are() {
    let folder = workshop();
    folder.run("cut a.obj --plane z=1 -o half.html").exits(0);
    assert!(folder.path("half-above.html").exists() && folder.path("half-below.html").exists());
    let object = folder.run("union a.obj b.obj -o u.html -o u.ply --json").exits(0).json();
    assert_eq!(object["outputs"][0]["format"], "html");
    let first = folder.read("u.html");
    folder.run("union a.obj b.obj -o u.html").exits(0);
    assert_eq!(folder.read("u.html"), first);
    folder.run("union a.obj b.obj -o u.unknown").exits(1).says("html");
}
