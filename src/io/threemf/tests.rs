//! Packages made by hand: what is read of them, and what is refused.

use std::io::{Cursor, Write as _};

use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use crate::control::Limit;
use crate::io::{Contents, Format, FormatError, Loaded, ReadOptions, WriteOptions, read, write};
use crate::mesh::Attribute;
use crate::{Control, Error, FaceGroup, Material, Mesh};

const ROOT: &str = "<Relationships xmlns=\"r\"><Relationship Id=\"a\" Target=\"/3D/m.model\" \
    Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";

const CORNERS: &str = "<vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/>\
    <vertex x=\"0\" y=\"1\" z=\"0\"/><vertex x=\"0\" y=\"0\" z=\"1\"/></vertices>";

const FACES: &str = "<triangles><triangle v1=\"0\" v2=\"2\" v3=\"1\"/><triangle v1=\"0\" v2=\"1\" v3=\"3\"/>\
    <triangle v1=\"1\" v2=\"2\" v3=\"3\"/><triangle v1=\"0\" v2=\"3\" v3=\"2\"/></triangles>";

/// A package of these parts.
fn package(parts: &[(&str, &str)]) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, text) in parts {
        zip.start_file(*name, SimpleFileOptions::DEFAULT).unwrap();
        zip.write_all(text.as_bytes()).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

/// A package with one model: attributes of its element, resources, build.
fn model(attributes: &str, resources: &str, build: &str) -> Vec<u8> {
    let text = model_text(attributes, resources, build);
    package(&[("_rels/.rels", ROOT), ("3D/m.model", &text)])
}

fn model_text(attributes: &str, resources: &str, build: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?><model xmlns=\"{}\" xmlns:m=\"{}\" xmlns:p=\"{}\" xmlns:t=\"{}\" {attributes}>\
         <resources>{resources}</resources><build>{build}</build></model>",
        super::space::CORE,
        super::space::MATERIALS,
        super::space::PRODUCTION,
        super::space::TRIANGLE_SETS
    )
}

fn tetrahedron(id: u32, attributes: &str) -> String {
    format!("<object id=\"{id}\" {attributes}><mesh>{CORNERS}{FACES}</mesh></object>")
}

fn loaded(bytes: &[u8]) -> Loaded {
    read(bytes, Format::ThreeMf, &ReadOptions::new()).unwrap()
}

/// What is said of bytes that are refused.
fn refused(bytes: &[u8]) -> String {
    read(bytes, Format::ThreeMf, &ReadOptions::new()).unwrap_err().to_string()
}

#[test]
fn items_and_components_are_moved_and_named() {
    let assembly = "<object id=\"2\" name=\"pair\"><components><component objectid=\"1\"/>\
        <component objectid=\"1\" transform=\"0 1 0 -1 0 0 0 0 1 5 0 0\"/></components></object>";
    let bytes = model(
        "unit=\"inch\"",
        &format!("{}{assembly}", tetrahedron(1, "name=\"one\"")),
        "<item objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 0 0 2\"/><item objectid=\"1\"/>",
    );
    let Loaded { mesh, warnings, .. } = loaded(&bytes);
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (12, 12));
    // Inches in millimetres; a row (x, y, z) times the matrix.
    assert_eq!(mesh.positions[0], [0.0, 0.0, 50.8]);
    assert_eq!(mesh.positions[5], [5.0 * 25.4, 25.4, 50.8]);
    assert_eq!(mesh.positions[6], [4.0 * 25.4, 0.0, 50.8]);
    assert_eq!(mesh.positions[9], [25.4, 0.0, 0.0]);
    let names: Vec<&str> = mesh.groups.list.iter().map(|group| group.name.as_str()).collect();
    assert_eq!(names, ["pair/one", "one"]);
    assert_eq!(mesh.groups.of_triangle, [[0; 8].as_slice(), &[1; 4]].concat());
    assert_eq!(warnings, ["the unit of the file is the inch; it is read in millimetres, times 25.4"]);
}

#[test]
fn a_mirror_turns_triangles_round() {
    let bytes =
        model("", &tetrahedron(1, ""), "<item objectid=\"1\" transform=\"-1 0 0 0 1 0 0 0 1 0 0 0\"/>");
    let mesh = loaded(&bytes).mesh;
    assert_eq!(mesh.triangles[0], [0, 1, 2]);
    assert!(mesh.groups.is_empty() && mesh.volume() > 0.0);
    // One so small that its determinant is none that a number can hold.
    let tiny = "<item objectid=\"1\" transform=\"-1e-120 0 0 0 1e-120 0 0 0 1e-120 0 0 0\"/>";
    assert_eq!(loaded(&model("", &tetrahedron(1, ""), tiny)).mesh.triangles[0], [0, 1, 2]);
}

#[test]
fn materials_colours_and_sets() {
    let resources = format!(
        "<basematerials id=\"5\"><base name=\"red &amp; hot\" displaycolor=\"#FF000080\"/>\
         <base name=\"x\" displaycolor=\"red\"/></basematerials>\
         <m:colorgroup id=\"6\"><m:color color=\"#FF0000\"/><m:color color=\"#00FF00\"/><m:color color=\"#0000FF\"/>\
         </m:colorgroup><m:texture2dgroup id=\"7\" texid=\"1\"/>\
         <object id=\"1\" pid=\"5\" pindex=\"0\"><mesh>{CORNERS}<triangles><triangle v1=\"0\" v2=\"2\" v3=\"1\"/>\
         <triangle v1=\"0\" v2=\"1\" v3=\"3\" p1=\"1\"/><triangle v1=\"1\" v2=\"2\" v3=\"3\" pid=\"6\" p1=\"0\" p2=\"1\" p3=\"2\"/>\
         <triangle v1=\"0\" v2=\"3\" v3=\"2\" pid=\"7\" p1=\"0\"/></triangles>\
         <t:trianglesets><t:triangleset name=\"a\" identifier=\"i\"><t:ref index=\"0\"/>\
         <t:refrange startindex=\"2\" endindex=\"3\"/><t:refrange startindex=\"3\" endindex=\"4\"/>\
         </t:triangleset></t:trianglesets></mesh></object>"
    );
    let Loaded { mesh, warnings, .. } = loaded(&model("", &resources, "<item objectid=\"1\"/>"));
    let groups: Vec<(&str, Option<&str>)> = (mesh.groups.list.iter())
        .map(|group| (group.name.as_str(), group.material.as_ref().map(|material| material.name.as_str())))
        .collect();
    assert_eq!(groups, [("a", Some("red & hot")), ("", Some("x")), ("a", None)]);
    assert_eq!(mesh.groups.of_triangle, [0, 1, 2, 2]);
    let red = mesh.groups.list[0].material.as_ref().unwrap();
    assert_eq!(red.base_color, [1.0, 0.0, 0.0, 128.0 / 255.0]);
    let [colours] = &mesh.attributes[..] else { panic!("{:?}", mesh.attributes) };
    assert_eq!((&*colours.name, colours.components), ("COLOR_0", 3));
    const NO: u32 = Attribute::NONE;
    assert_eq!(colours.of_corner, [NO, NO, NO, NO, NO, NO, 0, 1, 2, NO, NO, NO]);
    assert_eq!(colours.values, [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    assert_eq!(warnings.len(), 3, "{warnings:?}");
    assert!(warnings.iter().any(|warning| warning.contains("a picture for its material")));
}

#[test]
fn models_in_further_parts() {
    let root = model_text(
        "requiredextensions=\"p\"",
        "<object id=\"1\" p:UUID=\"u\"><components><component objectid=\"1\" p:path=\"/3D/Objects/a.model\"/></components></object>",
        "<item objectid=\"1\"/>",
    );
    let part = model_text("", &tetrahedron(1, "name=\"inner\""), "");
    let bytes = package(&[
        ("_rels/.rels", ROOT),
        ("3D/m.model", &root),
        ("3D/objects/A.model", &part),
        ("Metadata/thumbnail.png", "x"),
        ("Metadata/settings.config", "x"),
    ]);
    let Loaded { mesh, contents, warnings, .. } = loaded(&bytes);
    assert_eq!((mesh.triangles.len(), mesh.groups.list[0].name.as_str()), (4, "inner"));
    assert_eq!(contents, Contents { attachments: 2, ..Contents::default() });
    assert_eq!(contents.not_kept(), ["2 further files of the package not kept"]);
    assert!(warnings.is_empty(), "{warnings:?}");
    let missing = package(&[("_rels/.rels", ROOT), ("3D/m.model", &root)]);
    assert!(refused(&missing).contains("no such part"));
}

#[test]
fn what_is_written_is_read() {
    let mut mesh = crate::primitives::cuboid([-0.1; 3], [1.0 / 3.0, 1e-7, 1e21]).unwrap();
    let material = Material::plain("glass & <steel>", [1.0, 0.0, 1.0, 128.0 / 255.0]);
    mesh.groups.list = vec![
        FaceGroup { name: "top \"1\"".into(), material: Some(material) },
        FaceGroup { name: String::new(), material: None },
        FaceGroup { name: "side".into(), material: None },
    ];
    mesh.groups.of_triangle = vec![0, 0, 1, 1, 2, 2, 0, 0, 2, 2, 2, 2];
    let back = |mesh: &Mesh| {
        let mut bytes = Vec::new();
        let warnings = write(mesh, Format::ThreeMf, &mut bytes, &WriteOptions::new()).unwrap();
        (loaded(&bytes).mesh, warnings)
    };
    assert_eq!(back(&mesh), (mesh.clone(), vec![]));
    // With colours at some corners; those without keep their materials.
    mesh.attributes.push(Attribute {
        values: vec![1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0],
        of_corner: [vec![0, 1, 0, 1, 1, 0], vec![Attribute::NONE; 30]].concat(),
        ..Attribute::new("COLOR_0", 4)
    });
    let (again, warnings) = back(&mesh);
    assert_eq!(again.attributes, mesh.attributes);
    assert_eq!(again.groups.list[0], FaceGroup { name: mesh.groups.list[0].name.clone(), material: None });
    assert_eq!(warnings.len(), 1, "{warnings:?}");
}

#[test]
fn closed_groups_are_objects_and_seams_are_joined() {
    let mut pair = crate::primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
    let mut other = crate::primitives::cuboid([2.0; 3], [3.0; 3]).unwrap();
    for (mesh, name) in [(&mut pair, "a"), (&mut other, "b")] {
        mesh.groups.list.push(FaceGroup { name: name.into(), material: None });
        mesh.groups.of_triangle = vec![0; 12];
    }
    pair.append(&other).unwrap();
    let text = |mesh: &Mesh| {
        let mut bytes = Vec::new();
        write(mesh, Format::ThreeMf, &mut bytes, &WriteOptions::new()).unwrap();
        let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
        std::io::read_to_string(archive.by_name("3D/3dmodel.model").unwrap()).unwrap()
    };
    let two = text(&pair);
    assert!(
        two.contains("<object id=\"3\" type=\"model\" name=\"a\">")
            && two.contains("<object id=\"4\" type=\"model\" name=\"b\">")
    );
    assert_eq!(two.matches("<vertex ").count(), 16);
    // Triangles that share no vertex, as files with seams have them.
    let soup = Mesh::new(
        other.triangles.as_flattened().iter().map(|&corner| other.positions[corner as usize]).collect(),
        (0..12).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
    );
    let joined = text(&soup);
    assert!(joined.contains("type=\"model\"") && joined.matches("<vertex ").count() == 8);
    let open = Mesh::new(soup.positions, soup.triangles[1..].to_vec());
    assert!(text(&open).contains("type=\"surface\""));
}

#[test]
fn what_is_no_sound_package_is_refused() {
    let ok = tetrahedron(1, "");
    let item = "<item objectid=\"1\"/>";
    for (bytes, what) in [
        (b"PK\x03\x04 and so on".to_vec(), "cut off"),
        (package(&[("_rels/.rels", ROOT)]), "no such part"),
        (package(&[("a.txt", "a")]), "does not say which part"),
        (package(&[("_rels/.rels", &ROOT.replace("/3D/m.model", "../m.model"))]), "not the name of a part"),
        (model("", &ok, "<item objectid=\"2\"/>"), "not there"),
        (model("", &ok, "<item/>"), "without an objectid"),
        (model("", &ok, "<item objectid=\"1\" transform=\"1 2 3\"/>"), "not twelve numbers"),
        (model("unit=\"parsec\"", &ok, item), "the unit"),
        (model("", &ok.replace("v3=\"3\"", "v3=\"4\""), item), "vertex 4"),
        (model("", &ok.replace("x=\"1\"", "x=\"one\""), item), "not a number"),
        (model("", &ok.replace("x=\"1\"", "x=\"inf\""), item), "not a finite point"),
        (model("", &ok.replace("x=\"1\"", ""), item), "without a coordinate"),
        (model("", &ok.replace("v3=\"3\"", "v3=\"-3\""), item), "not a whole number"),
        (model("", &ok.replace("</object>", ""), item), "ill-formed"),
        (model("", &"<a>".repeat(1000), item), "256 deep"),
        (model("", "<vertex x=\"0\" y=\"0\" z=\"0\"/>", item), "in no object"),
        (model("xmlns:z=\"http://z/slice/1\" requiredextensions=\"p z\"", &ok, item), "needs slices"),
        (model("requiredextensions=\"q\"", &ok, item), "needs the extension \"q\""),
        (package(&[("_rels/.rels", ROOT), ("3D/m.model", "<a/>")]), "holds no model"),
        (package(&[("_rels/.rels", ROOT), ("3D/m.model", "\u{1}")]), "holds no model"),
    ] {
        let said = refused(&bytes);
        assert!(said.contains(what), "{what:?}: {said}");
    }
}

#[test]
fn a_document_type_is_refused() {
    let declared = model_text("", &tetrahedron(1, "name=\"&a;\""), "<item objectid=\"1\"/>").replace(
        "<?xml version=\"1.0\"?>",
        "<?xml version=\"1.0\"?><!DOCTYPE m [<!ENTITY a SYSTEM \"file:///etc/passwd\">]>",
    );
    let bytes = package(&[("_rels/.rels", ROOT), ("3D/m.model", &declared)]);
    assert!(refused(&bytes).contains("document type"));
    // Without one, nothing but the five entities of XML and numbers of characters mean anything.
    assert!(refused(&model("", &tetrahedron(1, "name=\"&a;\""), "")).contains("XML is damaged"));
    let named = loaded(&model("", &tetrahedron(1, "name=\"&lt;&#65;&#x42;\""), "<item objectid=\"1\"/>"));
    assert_eq!(named.mesh.groups.list[0].name, "<AB");
}

#[test]
fn what_would_unfold_without_end_is_refused() {
    let too_large = |bytes: &[u8]| {
        let error = read(bytes, Format::ThreeMf, &ReadOptions::new()).unwrap_err();
        assert!(matches!(error, Error::TooLarge { .. }), "{error}");
    };
    // A hundred megabytes of blanks.
    too_large(&model("", &" ".repeat(100 << 20), ""));
    // Two components of each level, forty levels deep.
    let levels: String = (2..42)
        .map(|id| {
            let component = format!("<component objectid=\"{}\"/>", id - 1);
            format!("<object id=\"{id}\"><components>{component}{component}</components></object>")
        })
        .collect();
    too_large(&model("", &(tetrahedron(1, "") + &levels), "<item objectid=\"41\"/>"));
    let circle = "<object id=\"2\"><components><component objectid=\"2\"/></components></object>";
    assert!(refused(&model("", circle, "<item objectid=\"2\"/>")).contains("in a circle"));
}

#[test]
fn long_names_and_texts_count_as_memory() {
    let refused = |bytes: &[u8], options: &ReadOptions| read(bytes, Format::ThreeMf, options).unwrap_err();
    // 1. A long name of an object that is part of the name of each of many groups: of its sets, or with its materials.
    let name = "n".repeat(100_000);
    let triangles = |more: &dyn Fn(usize) -> String| -> String {
        (0..1000).map(|i| format!("<triangle v1=\"0\" v2=\"1\" v3=\"2\"{}/>", more(i))).collect()
    };
    let object = |triangles: &str, sets: &str| {
        format!(
            "<object id=\"1\" name=\"{name}\"><mesh>{CORNERS}<triangles>{triangles}</triangles>{sets}</mesh></object>"
        )
    };
    let sets: String = (0..1000)
        .map(|i| format!("<t:triangleset name=\"{i}\"><t:ref index=\"{i}\"/></t:triangleset>"))
        .collect();
    let bases: String = (0..1000).map(|i| format!("<base name=\"{i}\"/>")).collect();
    let materials = format!("<basematerials id=\"5\">{bases}</basematerials>");
    let by_sets = object(&triangles(&|_| String::new()), &sets);
    let by_materials = materials + &object(&triangles(&|i| format!(" pid=\"5\" p1=\"{i}\"")), "");
    for resources in [by_sets, by_materials] {
        let error = refused(&model("", &resources, "<item objectid=\"1\"/>"), &ReadOptions::new());
        assert!(matches!(error, Error::TooLarge { .. }), "{error}");
    }
    // 2. Text that the parser holds as a whole, against a ceiling of memory.
    let options = ReadOptions::new().control(Control::new().memory_limit(8 << 20));
    let blanks = model("", &" ".repeat(20 << 20), "");
    assert!(blanks.len() < 1 << 20);
    let relations = ROOT.replace("<Relationship ", &format!("{}<Relationship ", " ".repeat(20 << 20)));
    let relations = package(&[("_rels/.rels", &relations), ("3D/m.model", "")]);
    for bytes in [blanks, relations] {
        let error = refused(&bytes, &options);
        assert!(matches!(error, Error::Limit(Limit::Memory { .. })), "{error}");
    }
    // 3. Many short texts are not held together.
    let many = model(
        "",
        &format!("{}{}", tetrahedron(1, ""), "<a>some text</a>".repeat(1 << 20)),
        "<item objectid=\"1\"/>",
    );
    assert_eq!(read(&many, Format::ThreeMf, &options).unwrap().mesh.triangles.len(), 4);
}

#[test]
fn cut_off_and_changed_bytes_are_errors_or_meshes() {
    let bytes = model("", &tetrahedron(1, "name=\"a\""), "<item objectid=\"1\"/>");
    for length in 0..bytes.len() {
        drop(read(&bytes[..length], Format::ThreeMf, &ReadOptions::new()));
    }
    for at in 0..bytes.len() {
        for change in [1, 0x80, 0xff] {
            let mut changed = bytes.clone();
            changed[at] ^= change;
            match read(&changed, Format::ThreeMf, &ReadOptions::new()) {
                Ok(_)
                | Err(Error::Format(FormatError::Malformed { .. } | FormatError::Unsupported { .. })) => {}
                Err(Error::TooLarge { .. }) => {}
                Err(other) => panic!("byte {at}: {other}"),
            }
        }
    }
}

#[test]
fn support_and_further_specifications_are_told() {
    let resources = format!(
        "{}{}<b:slicestack xmlns:b=\"http://schemas/slice/2015\"/>",
        tetrahedron(1, ""),
        tetrahedron(2, "type=\"support\"")
    );
    let build = "<item objectid=\"1\"/><item objectid=\"2\"/>";
    let Loaded { mesh, warnings, .. } = loaded(&model("", &resources, build));
    assert_eq!(mesh.triangles.len(), 4);
    assert_eq!(
        warnings,
        ["slices not kept (1 in all)", "object of the type \"support\" left out (1 in all)"]
    );
}
