//! What somebody types who has not read the manual: every line ends in the thing, or in a sentence that leads to it.

use super::common::program::Folder;

/// A command line, its exit code, and what it says on either stream.
const LINES: [(&str, i32, &str); 50] = [
    // Help in odd places.
    ("", 1, "Usage"),
    ("--help", 0, "Usage"),
    ("-h", 0, "union"),
    ("help", 0, "union"),
    ("help union", 0, "Transforms"),
    ("union --help", 0, "Transforms"),
    ("union -h", 0, "--output"),
    ("help cut", 0, "--plane"),
    ("--version", 0, "trisect"),
    ("-V", 0, "trisect"),
    ("version", 1, "--version"),
    ("union", 1, "Usage"),
    // Old habits and other words.
    ("subtract a.off b.off -o c.off", 0, "result"),
    ("merge a.off b.off -o c.off", 0, "result"),
    ("add a.off b.off -o c.off", 0, "result"),
    ("intersect a.off b.off -o c.off", 0, "result"),
    ("minus a.off b.off -o c.off", 1, "`difference`"),
    ("Union a.off b.off -o c.off", 1, "union"),
    ("unoin a.off b.off -o c.off", 1, "'union'"),
    ("a.off b.off -o c.off", 1, "a verb comes first"),
    ("-o c.off a.off b.off", 1, "verb"),
    ("repair a.off", 1, "`check`"),
    ("render a.off", 1, "--png"),
    ("array a.off", 1, "--pattern"),
    ("thicken a.off", 1, "`offset`"),
    ("simplify a.off", 1, "no such operation"),
    ("volume a.off", 1, "`measure`"),
    ("collision a.off b.off", 1, "`distance`"),
    // Options that are nearly right.
    ("union a.off b.off --ouput c.off", 1, "--output"),
    ("union a.off b.off -out c.off", 1, "out"),
    ("union a.off b.off", 1, "-o FILE"),
    ("union a.off b.off c.off", 1, "-o FILE"),
    ("union a.off b.off -o c", 1, "known endings"),
    ("union a.off b.off -o c.step", 1, "known endings"),
    ("union a.off none.off -o c.off", 2, "none.off"),
    ("cut a.off b.off -o c.off", 1, "trisect difference a.off b.off"),
    ("cut a.off --at 0 -o c.off", 1, "--plane"),
    ("slice a.off -o s.svg", 1, "*.png"),
    ("section a.off --plane z=0.5 -o s.png", 1, "svg"),
    ("grid a.off --spacing 0.5 -o g.vti", 1, "*.npy"),
    ("convert a.off --rotate 45 --scale 200% -o c.stl", 0, "c.stl"),
    ("subtract a.off -b b.off -o c.off", 1, "trisect difference BODY TOOL"),
    ("slice a.off --layer 0.2", 1, "trisect section"),
    ("offset a.off 0.1 -o c.off", 1, "--distance 0.1"),
    ("offset a.off -0.1 -o c.off", 1, "--distance -0.1"),
    ("hollow a.off 0.1 -o c.off", 1, "--wall 0.1"),
    ("cut a.off z=0.5 -o c.off", 1, "--plane z=0.5"),
    ("intersection a.off b.off -o", 1, "-o result.stl"),
    ("union a.off b.off --output", 1, "-o result.stl"),
    ("union --translate 1,0,0 a.off b.off -o c.off", 1, "before the first input"),
];

#[test]
fn a_strangers_lines_lead_somewhere() {
    for (line, code, text) in LINES {
        let folder = Folder::new();
        folder.run("convert box:1 -o a.off").exits(0);
        folder.run("convert box:1 --translate 0.5,0.5,0.5 -o b.off").exits(0);
        let ran = folder.run(line);
        assert_eq!(ran.code, code, "trisect {line}: {ran:?}");
        assert!(
            ran.err.contains(text) || ran.out.contains(text),
            "trisect {line}: '{text}' is missing: {ran:?}"
        );
        // One kind of beginning for all that went wrong.
        assert!(
            code == 0
                || line.is_empty()
                || ran.err.starts_with("trisect: error: ")
                || ran.err.contains("Usage"),
            "{ran:?}"
        );
        assert!(!ran.err.starts_with("error:"), "{ran:?}");
    }
}

#[test]
fn completions_name_every_verb_for_every_shell() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let ran = folder.run(&format!("completions {shell}")).exits(0);
        for word in ["union", "difference", "minkowski", "hollow", "--pattern", "color-by"] {
            assert!(ran.out.contains(word.trim_start_matches('-')), "{shell}: {word}");
        }
    }
    folder.run("completions csh").exits(1).says("possible values");
}

#[test]
fn the_manual_has_a_page_for_every_verb() {
    let folder = Folder::new();
    folder.run("man").exits(0).prints(".TH trisect").prints("trisect\\-union");
    folder.run("man hollow").exits(0).prints("\\-\\-wall").prints("\\-\\-threads");
    folder.run("man curve join").exits(0).prints("\\-\\-metric");
    folder.run("man nothing").exits(1).says("no verb");
    std::fs::create_dir(folder.path("man1")).expect("a folder");
    folder.run("man --folder man1").exits(0);
    for name in ["trisect.1", "trisect-union.1", "trisect-curve-join.1"] {
        assert!(folder.exists(&format!("man1/{name}")), "{name}");
    }
    folder.run("man --folder none").exits(2).says("none");
}
