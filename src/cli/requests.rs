//! Inputs as the command line names them: which transforms belong to which file, and its format.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::ArgMatches;
use trisect::Rule;
use trisect::io::Format;

use super::chosen::{self, Chosen};
use super::fault::Fault;
use super::repairs::Repairs;
use super::shapes::{self, Setting};
use super::stream::STANDARD;
use super::transforms::{self, Transform};

/// An input as the command line names it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Request {
    pub(crate) path: PathBuf,
    /// The name or pattern of parts of the file.
    pub(crate) part: Option<String>,
    /// What was read of the file already.
    pub(crate) chosen: Option<Arc<Chosen>>,
    pub(crate) format: Option<Format>,
    /// How many times the bytes of its file a scene may take; `None` for what the library allows.
    pub(crate) expansion: Option<u64>,
    pub(crate) transforms: Vec<Transform>,
    pub(crate) repairs: Repairs,
    /// What is inside, where the surface crosses itself.
    pub(crate) rule: Rule,
    /// Whether it is a node whose scene stays: one without a mesh is then a place for one.
    pub(crate) is_place: bool,
}

impl Request {
    /// The name in messages.
    pub(crate) fn name(&self) -> String {
        let file = if self.is_standard() { "standard input".into() } else { self.path.display().to_string() };
        let chosen = self.chosen.as_ref().and_then(|chosen| chosen.name.as_ref());
        match chosen.or(self.part.as_ref()) {
            Some(part) => format!("{file}#{part}"),
            None => file,
        }
    }

    /// What the result's groups are called by: the name of the part, or else of the file without folders and ending.
    pub(crate) fn short_name(&self) -> String {
        let chosen = self.chosen.as_ref().and_then(|chosen| chosen.name.as_ref());
        if let Some(part) = chosen.or(self.part.as_ref()) {
            return part.clone();
        }
        let stem = self.path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        stem.filter(|stem| !stem.is_empty() && stem != STANDARD).unwrap_or_else(|| "input".into())
    }

    /// Whether the input is a cage that is to be subdivided.
    pub(crate) fn is_cage(&self) -> bool {
        #[cfg(feature = "subdivision")]
        return self.transforms.iter().any(|transform| matches!(transform, Transform::Subdivide(_)));
        #[cfg(not(feature = "subdivision"))]
        false
    }

    /// Whether this is standard input.
    pub(crate) fn is_standard(&self) -> bool {
        self.path == Path::new(STANDARD)
    }
}

/// The inputs among a verb's matches, each with the transforms that stand after it and before the next one.
pub(crate) fn requests(matches: &ArgMatches, format: Option<Format>) -> Result<Vec<Request>, Fault> {
    let mut requests = placed_requests(matches)?;
    name_formats(&mut requests, format)?;
    Ok(requests)
}

/// The files and their transforms, formats left open.
///
/// clap numbers every value by its place on the command line ([`ArgMatches::indices_of`]); sorting files and
/// transforms by that number restores the order in which they were written.
pub(crate) fn placed_requests(matches: &ArgMatches) -> Result<Vec<Request>, Fault> {
    placed_inputs(matches, |path| path)
}

/// The same with other names for the inputs.
pub(crate) fn placed_inputs(
    matches: &ArgMatches,
    name: impl Fn(PathBuf) -> PathBuf,
) -> Result<Vec<Request>, Fault> {
    let expansion = matches.try_get_one::<u64>("expansion").ok().flatten().copied();
    let mut requests: Vec<Request> = Vec::new();
    let (mut for_all, mut rule_for_all) = (Repairs::default(), Rule::default());
    let (mut settings, mut setting_for_all) = (Vec::<Setting>::new(), Setting::default());
    for item in items(matches, name) {
        match (item, requests.last_mut()) {
            (Item::File(path), _) => {
                let (path, part) =
                    if shapes::named(&path).is_some() { (path, None) } else { chosen::split(path) };
                settings.push(Setting::default());
                let (format, chosen, transforms) = (None, None, Vec::new());
                let (repairs, rule) = (Repairs::default(), rule_for_all);
                requests.push(Request {
                    path,
                    part,
                    chosen,
                    format,
                    expansion,
                    transforms,
                    repairs,
                    rule,
                    is_place: false,
                });
            }
            (Item::Rule(rule), Some(request)) => request.rule = rule,
            (Item::Rule(rule), None) => rule_for_all = rule,
            (Item::Setting(setting), _) => match settings.last_mut() {
                Some(last) => *last = setting.or(last),
                None => setting_for_all = setting.or(&setting_for_all),
            },
            (Item::Transform(_, transform), Some(request)) => request.transforms.push(transform),
            (Item::Repair(repairs), Some(request)) => request.repairs = repairs.with(request.repairs),
            (Item::Repair(repairs), None) => for_all = repairs.with(for_all),
            (Item::Transform(name, _), None) => {
                return Err(Fault::usage(format!(
                    "{name} stands before the first input; a transform applies to the input just before it"
                )));
            }
        }
    }
    for (request, setting) in requests.iter_mut().zip(settings) {
        make_shape(request, setting, &setting_for_all)?;
        request.repairs = request.repairs.with(for_all);
        if let Some(other) = request.repairs.contradiction() {
            return Err(Fault::usage(format!(
                "{}: --as-is and {other} contradict each other",
                request.name()
            )));
        }
    }
    Ok(requests)
}

/// An input, or something that is said of one.
enum Item {
    File(PathBuf),
    Transform(&'static str, Transform),
    Repair(Repairs),
    Rule(Rule),
    Setting(Setting),
}

/// All inputs and what is said of them, in the order of the command line.
fn items(matches: &ArgMatches, name: impl Fn(PathBuf) -> PathBuf) -> Vec<Item> {
    let mut items: Vec<(usize, Item)> =
        placed::<PathBuf>(matches, "files").map(|(at, path)| (at, Item::File(name(path)))).collect();
    let transforms = transforms::all(matches).into_iter();
    items.extend(transforms.map(|(at, name, what)| (at, Item::Transform(name, what))));
    items.extend(placed_repairs(matches).into_iter().map(|(at, repairs)| (at, Item::Repair(repairs))));
    if matches.try_contains_id("rule").is_ok() {
        items.extend(placed(matches, "rule").map(|(at, rule)| (at, Item::Rule(rule))));
    }
    items.extend(placed_settings(matches).into_iter().map(|(at, setting)| (at, Item::Setting(setting))));
    items.sort_by_key(|&(at, _)| at);
    items.into_iter().map(|(_, item)| item).collect()
}

/// Makes the mesh of an input that is no file; refuses options for text at inputs that are none.
fn make_shape(request: &mut Request, setting: Setting, for_all: &Setting) -> Result<(), Fault> {
    let kind = shapes::named(&request.path).map(|(kind, _)| kind);
    if setting.is_some() && kind != Some("text") {
        return Err(Fault::usage(format!(
            "{}: --font, --size, --depth and --justify are for inputs text:...",
            request.name()
        )));
    }
    if kind.is_some() {
        let made = shapes::made(&request.path, &setting.or(for_all))?;
        request.chosen = Some(Arc::new(made));
    }
    Ok(())
}

/// What is asked to be mended, each with its place on the command line. Not every verb takes such options.
fn placed_repairs(matches: &ArgMatches) -> Vec<(usize, Repairs)> {
    let none = Repairs::default();
    let mut repairs = Vec::new();
    let takes = |id| matches.try_contains_id(id).is_ok();
    let flags = [
        ("orient", Repairs { orient: true, ..none }),
        ("closed_parts", Repairs { closed_parts: true, ..none }),
        ("refine_holes", Repairs { refine_holes: true, ..none }),
        ("as_is", Repairs { as_is: true, ..none }),
    ];
    for (id, asked) in flags {
        if takes(id) {
            repairs.extend(placed::<bool>(matches, id).map(|(at, _)| (at, asked)));
        }
    }
    if takes("fill_holes") {
        let filling = placed::<usize>(matches, "fill_holes");
        repairs.extend(filling.map(|(at, most)| (at, Repairs { fill_holes: Some(most), ..none })));
    }
    if takes("weld") {
        repairs.extend(placed(matches, "weld").map(|(at, weld)| (at, Repairs { weld, ..none })));
    }
    repairs
}

/// How texts are to be set, each option with its place on the command line.
fn placed_settings(matches: &ArgMatches) -> Vec<(usize, Setting)> {
    let none = Setting::default;
    let mut settings: Vec<(usize, Setting)> = Vec::new();
    if matches.try_contains_id("font").is_ok() {
        settings
            .extend(placed(matches, "font").map(|(at, font)| (at, Setting { font: Some(font), ..none() })));
        settings
            .extend(placed(matches, "size").map(|(at, size)| (at, Setting { size: Some(size), ..none() })));
        settings.extend(
            placed(matches, "depth").map(|(at, depth)| (at, Setting { depth: Some(depth), ..none() })),
        );
        let justified = placed(matches, "justify");
        settings.extend(justified.map(|(at, justify)| (at, Setting { justify: Some(justify), ..none() })));
    }
    settings
}

/// The values of an argument, each with its place on the command line.
pub(crate) fn placed<T: Clone + Send + Sync + 'static>(
    matches: &ArgMatches,
    id: &str,
) -> impl Iterator<Item = (usize, T)> {
    let values: Vec<T> = matches.get_many::<T>(id).into_iter().flatten().cloned().collect();
    let places: Vec<usize> = matches.indices_of(id).into_iter().flatten().collect();
    places.into_iter().zip(values)
}

/// `--format` is for standard input, or for every input when standard input is not among them.
pub(crate) fn name_formats(requests: &mut [Request], format: Option<Format>) -> Result<(), Fault> {
    let standard = requests.iter().filter(|request| request.is_standard()).count();
    if standard > 1 {
        return Err(Fault::usage("standard input can be only one of the inputs"));
    }
    if standard == 1 && format.is_none() {
        return Err(Fault::usage(
            "standard input has no name to tell its format; add --format, such as --format stl",
        ));
    }
    for request in requests {
        if request.is_standard() || standard == 0 {
            request.format = format;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;
    use trisect::mesh::Welding;

    use super::*;
    use crate::cli::arguments::Arguments;

    fn parse(line: &str) -> Result<Vec<Request>, Fault> {
        let matches = Arguments::command().try_get_matches_from(line.split(' ')).expect("clap accepts it");
        let (_, matches) = matches.subcommand().expect("a verb");
        requests(matches, matches.get_one::<Format>("format").copied())
    }

    #[test]
    fn transforms_belong_to_the_input_before_them_in_their_order() {
        let requests = parse(
            "trisect union a.obj --scale 2 --translate -1,0,0 --scale 3 -q b.obj c.obj -o x.obj --rotate 0,0,90",
        )
        .expect("valid");
        let transforms: Vec<Vec<String>> = requests
            .iter()
            .map(|request| request.transforms.iter().map(ToString::to_string).collect())
            .collect();
        assert_eq!(transforms[0], ["scale 2,2,2", "translate -1,0,0", "scale 3,3,3"]);
        assert!(transforms[1].is_empty());
        assert_eq!(transforms[2], ["rotate 0,0,90"]);
    }

    #[test]
    fn a_transform_before_the_first_input_is_refused() {
        let fault = parse("trisect union --translate 1,0,0 a.obj b.obj").expect_err("no input before it");
        assert!(fault.message.contains("--translate stands before the first input"));
    }

    #[test]
    fn equal_files_stay_separate_inputs() {
        let requests = parse("trisect union a.obj a.obj --translate 1,0,0").expect("valid");
        assert_eq!([requests[0].transforms.len(), requests[1].transforms.len()], [0, 1]);
    }

    #[test]
    fn format_is_for_standard_input_if_there_is_one() {
        let formats = |line| {
            parse(line).map(|requests| requests.iter().map(|request| request.format).collect::<Vec<_>>())
        };
        assert_eq!(formats("trisect union - b.obj --format stl").expect("valid"), [Some(Format::Stl), None]);
        assert_eq!(formats("trisect union a b --format off").expect("valid"), [Some(Format::Off); 2]);
        assert!(formats("trisect union - b.obj").is_err());
        assert!(formats("trisect union - - --format stl").is_err());
    }

    #[test]
    fn repairs_belong_to_the_input_before_them_or_to_all() {
        let requests = parse(
            "trisect union --closed-parts --weld 1 a.obj --orient b.obj --weld auto --weld 2 c.obj -o x.obj --orient",
        )
        .expect("valid");
        let repairs: Vec<Repairs> = requests.iter().map(|request| request.repairs).collect();
        assert!(repairs.iter().all(|repairs| repairs.closed_parts && !repairs.as_is));
        assert_eq!(repairs.iter().map(|repairs| repairs.orient).collect::<Vec<_>>(), [true, false, true]);
        let welds: Vec<Welding> = repairs.iter().map(|repairs| repairs.weld).collect();
        assert_eq!(welds, [Welding::Within(1.0), Welding::Within(2.0), Welding::Within(1.0)]);
        let fault = parse("trisect union --as-is a.obj b.obj --weld auto").expect_err("a contradiction");
        assert!(fault.message.contains("b.obj: --as-is and --weld"), "{}", fault.message);
    }
}
