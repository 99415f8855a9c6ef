//! Text as solids: outlines of TrueType and OpenType fonts, extruded.
//!
//! Curves of outlines become polygons within a tolerance; these are extruded as they are. Where outlines of a letter overlap (as in
//! fonts with variations) what they wind around is worked out exactly by the arrangement.

use std::path::Path;

use ttf_parser::{Face, GlyphId, OutlineBuilder};

use crate::boolean::{BooleanOptions, Rule};
use crate::primitives::prism;
use crate::{Error, FileAction, Mesh, Solid};

/// A font: the bytes of a TrueType or OpenType file.
#[derive(Clone, Debug)]
pub struct Font {
    data: Vec<u8>,
}

/// To which side lines of text are flush.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum TextAlign {
    /// Lines begin at x = 0.
    #[default]
    Left,
    /// The middle of every line is at x = 0.
    Center,
    /// Lines end at x = 0.
    Right,
}

/// How text is set.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Lettering {
    /// The size of the font, its em, in units of the coordinates: capitals are about 0.7 of it.
    pub size: f64,
    /// How far it is extruded, from z = 0 upwards.
    pub depth: f64,
    /// The largest distance between an outline and its polygon; `None` for a thousandth of the size.
    pub tolerance: Option<f64>,
    /// To which side lines are flush.
    pub align: TextAlign,
}

impl Lettering {
    /// Text of this size and depth, flush left.
    #[must_use]
    pub fn new(size: f64, depth: f64) -> Self {
        Self { size, depth, tolerance: None, align: TextAlign::default() }
    }

    /// The same within another tolerance.
    #[must_use]
    pub fn tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = Some(tolerance);
        self
    }

    /// The same flush to another side.
    #[must_use]
    pub fn align(mut self, align: TextAlign) -> Self {
        self.align = align;
        self
    }

    /// The text as a closed mesh: every letter a prism, its baseline on y = 0, further lines below. Lines end at `\n`. Letters are
    /// as far apart as the font says, with the pairs of its `kern` table. Letters that overlap are an operand that crosses itself,
    /// and resolved as such.
    ///
    /// ```no_run
    /// use trisect::making::{Font, Lettering};
    /// use trisect::{Solid, primitives};
    ///
    /// let font = Font::load("DejaVuSans.ttf".as_ref())?;
    /// let letters = Lettering::new(8.0, 2.0).mesh("No 42", &font)?.translated([5.0, 5.0, 9.0]);
    /// let block = Solid::try_from(primitives::cuboid([0.0; 3], [50.0, 20.0, 10.0])?)?;
    /// let engraved = block.difference(&Solid::try_from(letters)?)?;
    /// # Ok::<(), trisect::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if a length is not positive and finite, the font lacks a character or its outline, there is nothing
    /// to be seen of the text, or an outline of a letter crosses itself.
    pub fn mesh(&self, text: &str, font: &Font) -> Result<Mesh, Error> {
        let tolerance = self.tolerance.unwrap_or(self.size * 1e-3);
        for (name, length) in [("size", self.size), ("depth", self.depth), ("tolerance", tolerance)] {
            if !(length > 0.0 && length.is_finite()) {
                return invalid(format!("the {name} must be positive and finite, not {length}"));
            }
        }
        let face = font.face().map_err(|what| Error::InvalidArgument(format!("text: {what}")))?;
        let scale = self.size / f64::from(face.units_per_em());
        let step = f64::from(face.ascender()) - f64::from(face.descender()) + f64::from(face.line_gap());
        let mut letters = Vec::new();
        for (number, line) in text.split('\n').enumerate() {
            let (glyphs, width) = set(line, &face)?;
            let left = match self.align {
                TextAlign::Left => 0.0,
                TextAlign::Center => -width / 2.0,
                TextAlign::Right => -width,
            };
            for (glyph, character, x) in glyphs {
                let outline = Outline::of(&face, glyph, character, tolerance / scale)?;
                let place = [left + x, -step * number as f64];
                let loops = outline.finished(|[x, y]| [(x + place[0]) * scale, (y + place[1]) * scale]);
                if !loops.is_empty() {
                    letters.push(letter(&loops, self.depth, character)?);
                }
            }
        }
        if letters.is_empty() {
            return invalid("there is nothing to be seen of it");
        }
        Ok(Mesh::merged(&letters)?)
    }
}

impl Font {
    /// Reads a font file.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be read, or is no font.
    pub fn load(path: &Path) -> Result<Self, Error> {
        let failed = |source| Error::File { action: FileAction::Read, path: path.to_path_buf(), source };
        let data = std::fs::read(path).map_err(failed)?;
        Self::new(data).map_err(|what| failed(std::io::Error::new(std::io::ErrorKind::InvalidData, what)))
    }

    /// A font from the bytes of its file; of a collection the first.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn new(data: Vec<u8>) -> Result<Self, String> {
        let font = Self { data };
        font.face()?;
        Ok(font)
    }

    fn face(&self) -> Result<Face<'_>, String> {
        Face::parse(&self.data, 0)
            .map_err(|error| format!("it is no TrueType or OpenType font (*.ttf, *.otf, *.ttc): {error}"))
    }
}

fn invalid<T>(what: impl Into<String>) -> Result<T, Error> {
    Err(Error::InvalidArgument(format!("text: {}", what.into())))
}

/// A glyph with its character, and where it begins in its line, in units of the font.
type Placed = (GlyphId, char, f64);

/// The glyphs of a line, and how wide all are, in units of the font.
fn set(line: &str, face: &Face<'_>) -> Result<(Vec<Placed>, f64), Error> {
    let (mut glyphs, mut x) = (Vec::new(), 0.0);
    let mut before: Option<GlyphId> = None;
    for character in line.chars().filter(|&character| character != '\r') {
        let Some(glyph) = face.glyph_index(character) else {
            return invalid(format!(
                "the font has no character '{character}' (U+{:04X}); take another font",
                u32::from(character)
            ));
        };
        let pairs = face.tables().kern.into_iter().flat_map(|kern| kern.subtables);
        let pairs = pairs.filter(|table| table.horizontal && !table.variable && !table.has_state_machine);
        if let Some(before) = before {
            x += pairs.filter_map(|table| table.glyphs_kerning(before, glyph)).map(f64::from).sum::<f64>();
        }
        glyphs.push((glyph, character, x));
        x += f64::from(face.glyph_hor_advance(glyph).unwrap_or_default());
        before = Some(glyph);
    }
    Ok((glyphs, x))
}

/// Whether a character is there without being seen: blanks, marks for breaks and joins, and what chooses between pictures.
fn is_blank(character: char) -> bool {
    character.is_whitespace()
        || character.is_control()
        || matches!(
            character,
            '\u{ad}' | '\u{34f}' | '\u{61c}' | '\u{115f}' | '\u{1160}' | '\u{17b4}' | '\u{17b5}' | '\u{180b}'..='\u{180f}'
                | '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{2800}' | '\u{3164}'
                | '\u{fe00}'..='\u{fe0f}' | '\u{feff}' | '\u{ffa0}' | '\u{e0000}'..='\u{e0fff}'
        )
}

/// One letter as a prism. Outlines that cross each other, or lie in each other and run the same way, are added up by their windings.
fn letter(loops: &[Vec<[f64; 2]>], depth: f64, character: char) -> Result<Mesh, Error> {
    // Both areas are right to this; an outline within another one makes more.
    const SAME: f64 = 1e-9;
    let areas: Vec<f64> = loops.iter().map(|outline| signed_area(outline)).collect();
    if let Ok(mesh) = prism(loops, 0.0, depth) {
        // By parity a loop in a loop is a hole. It is one by winding too if it runs the other way, and then their areas say so.
        let by_winding = areas.iter().sum::<f64>().abs() * depth;
        let by_parity = mesh.volume();
        if (by_winding - by_parity).abs() <= SAME * by_parity {
            return Ok(mesh);
        }
    }
    let mut all = Mesh::default();
    for (outline, area) in loops.iter().zip(areas) {
        let one = prism(std::slice::from_ref(outline), 0.0, depth).map_err(|error| {
            Error::InvalidArgument(format!(
                "text: an outline of the letter '{character}' crosses itself: {error}"
            ))
        })?;
        // (TrueType's outlines run clockwise.)
        all.append(&if area < 0.0 { one } else { one.reversed() })?;
    }
    if all.volume() < 0.0 {
        all = all.reversed();
    }
    let options = BooleanOptions::new().rule(Rule::NonZero);
    Ok(options.resolve(&Solid::try_from(all)?)?.into_solid().into_mesh())
}

/// The area within a polygon, negative where it runs clockwise. (Seen from its first point, so that places far away lose nothing.)
fn signed_area(outline: &[[f64; 2]]) -> f64 {
    let Some(&[x, y]) = outline.first() else { return 0.0 };
    let from_first = |[a, b]: [f64; 2]| [a - x, b - y];
    let doubled = outline.windows(2).map(|ends| {
        let [[a, b], [c, d]] = [from_first(ends[0]), from_first(ends[1])];
        a * d - b * c
    });
    doubled.sum::<f64>() / 2.0
}

/// Polygons of outlines as they are drawn.
struct Outline {
    /// In units of the font.
    tolerance: f64,
    loops: Vec<Vec<[f64; 2]>>,
    at: [f64; 2],
    points: usize,
}

impl Outline {
    /// The most points of a letter: a font may put one glyph together from itself thousands of times over.
    const MOST: usize = 1_000_000;

    /// What a font draws for a character. Only blanks may have no outline, as pictures in colour have none either.
    fn of(face: &Face<'_>, glyph: GlyphId, character: char, tolerance: f64) -> Result<Self, Error> {
        let mut outline = Self { tolerance, loops: Vec::new(), at: [0.0; 2], points: 0 };
        let is_whole = face.outline_glyph(glyph, &mut outline).is_some();
        let letter = || format!("'{character}' (U+{:04X})", u32::from(character));
        if outline.points > Self::MOST {
            return invalid(format!("the letter {} has more than {} points", letter(), Self::MOST));
        }
        let may_be_empty = outline.loops.is_empty() && is_blank(character);
        if !is_whole && !may_be_empty {
            return invalid(format!(
                "the font has no outline of the character {}, or one that is damaged; take another font",
                letter()
            ));
        }
        Ok(outline)
    }

    fn to(&mut self, point: [f64; 2]) {
        self.at = point;
        self.points += 1;
        if let Some(points) = self.loops.last_mut().filter(|_| self.points <= Self::MOST) {
            points.push(point);
        }
    }

    /// Points of a curve whose second derivative is at most `bend`: chords of n equal parts are off by bend / (8 n^2).
    fn along(&mut self, bend: f64, point: impl Fn(f64) -> [f64; 2]) {
        // A letter with more points than that on one curve is none.
        const MOST: f64 = 1000.0;
        let parts = (bend / (8.0 * self.tolerance)).sqrt().ceil().clamp(1.0, MOST) as u32;
        // (Where the tolerance underflows, zero by zero is no number, and becomes 0.)
        let parts = parts.max(1);
        for k in 1..=parts {
            self.to(point(f64::from(k) / f64::from(parts)));
        }
    }

    /// The loops at their places, without points that repeat the one before and without those of no area.
    fn finished(self, place: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<Vec<[f64; 2]>> {
        let cleaned = |points: Vec<[f64; 2]>| {
            let mut points: Vec<[f64; 2]> = points.into_iter().map(&place).collect();
            points.dedup();
            while points.len() > 1 && points.first() == points.last() {
                points.pop();
            }
            points
        };
        self.loops.into_iter().map(cleaned).filter(|points| points.len() > 2).collect()
    }
}

impl OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        if self.points < Self::MOST {
            self.loops.push(Vec::new());
        }
        self.to([x.into(), y.into()]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.to([x.into(), y.into()]);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let (a, b, c) = (self.at, [f64::from(x1), f64::from(y1)], [f64::from(x), f64::from(y)]);
        let second = [0, 1].map(|k| 2.0 * (a[k] - 2.0 * b[k] + c[k]));
        self.along(second[0].hypot(second[1]), |t| {
            let s = 1.0 - t;
            if t == 1.0 { c } else { [0, 1].map(|k| s * s * a[k] + 2.0 * s * t * b[k] + t * t * c[k]) }
        });
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let (a, b) = (self.at, [f64::from(x1), f64::from(y1)]);
        let (c, d) = ([f64::from(x2), f64::from(y2)], [f64::from(x), f64::from(y)]);
        let bend = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
            let second = [0, 1].map(|k| 6.0 * (p[k] - 2.0 * q[k] + r[k]));
            second[0].hypot(second[1])
        };
        self.along(bend(a, b, c).max(bend(b, c, d)), |t| {
            let s = 1.0 - t;
            let at = |k: usize| s * s * s * a[k] + 3.0 * s * t * (s * b[k] + t * c[k]) + t * t * t * d[k];
            if t == 1.0 { d } else { [at(0), at(1)] }
        });
    }

    fn close(&mut self) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    fn font() -> Font {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/fonts/DejaVuSans-Latin.ttf");
        Font::load(&path).unwrap()
    }

    fn solid(text: &str) -> Solid {
        Solid::try_from(Lettering::new(10.0, 2.0).mesh(text, &font()).unwrap()).unwrap()
    }

    #[test]
    fn letters_are_closed_and_have_their_holes() {
        for (text, shells, genus) in
            [("I", 1, 0), ("O", 1, 1), ("B8", 2, 4), ("i", 2, 0), ("Abc 42%", 6 + 2, 5)]
        {
            let solid = solid(text);
            assert!(solid.is_manifold(), "{text}");
            assert_eq!((solid.components(), solid.genus()), (shells, Some(genus)), "{text}");
        }
        let bounds = solid("H").bounds().unwrap();
        assert_eq!((bounds.low[1], bounds.low[2], bounds.high[2]), (0.0, 0.0, 2.0));
        assert!((bounds.high[1] - 7.29).abs() < 0.01, "{bounds:?}");
    }

    #[test]
    fn finer_outlines_enclose_what_coarser_ones_do_within_the_tolerance() {
        let volume = |tolerance: f64| {
            let mesh = Lettering::new(10.0, 1.0).tolerance(tolerance).mesh("O", &font()).unwrap();
            (mesh.volume(), mesh.triangles.len())
        };
        let (coarse, fine, finest) = (volume(0.1), volume(0.001), volume(1e-5));
        assert!(coarse.1 < fine.1 && fine.1 < finest.1);
        // Two rings, no longer than 30 each.
        assert!((coarse.0 - finest.0).abs() < 60.0 * 0.1 && (fine.0 - finest.0).abs() < 60.0 * 0.001);
    }

    #[test]
    fn lines_stand_below_each_other_on_the_side_they_are_flush_to() {
        let bounds = |align| {
            let mesh = Lettering::new(10.0, 1.0).align(align).mesh("III\nI", &font()).unwrap();
            mesh.bounds().unwrap()
        };
        let (left, center, right) =
            (bounds(TextAlign::Left), bounds(TextAlign::Center), bounds(TextAlign::Right));
        assert!(left.low[0] > 0.0 && right.high[0] < 0.0 && (center.center()[0]).abs() < 1e-6);
        assert!(left.low[1] < -10.0 && left.high[1] > 7.0);
        // Pairs are nearer to each other than their letters by themselves.
        let width = |text: &str| solid(text).bounds().unwrap().size()[0];
        assert!(width("AV") < width("A") + width("V"));
    }

    #[test]
    fn outlines_that_overlap_are_added_up() {
        let square = |x: f64, clockwise: bool| {
            let mut points = vec![[x, 0.0], [x + 2.0, 0.0], [x + 2.0, 2.0], [x, 2.0]];
            if clockwise {
                points.reverse();
            }
            points
        };
        for clockwise in [false, true] {
            let mesh = letter(&[square(0.0, clockwise), square(1.0, clockwise)], 1.0, 'x').unwrap();
            assert_eq!(Solid::try_from(mesh).unwrap().volume(), 6.0);
        }
    }

    #[test]
    fn outlines_within_others_are_holes_if_they_run_the_other_way() {
        let square = |low: f64, high: f64| vec![[low, low], [high, low], [high, high], [low, high]];
        let reversed = |mut points: Vec<[f64; 2]>| {
            points.reverse();
            points
        };
        let volume = |loops: &[Vec<[f64; 2]>]| letter(loops, 1.0, 'x').unwrap().volume();
        assert_eq!(volume(&[square(0.0, 4.0), reversed(square(1.0, 3.0))]), 12.0);
        assert_eq!(volume(&[square(0.0, 4.0), square(1.0, 3.0)]), 16.0);
        assert_eq!(volume(&[reversed(square(0.0, 4.0)), reversed(square(1.0, 3.0))]), 16.0);
        // Side by side it does not matter.
        assert_eq!(volume(&[square(0.0, 4.0), reversed(square(5.0, 6.0))]), 17.0);
    }

    #[test]
    fn letters_without_an_outline_are_told_and_blanks_are_not() {
        // The outline of A, as long as nothing: its end in `loca` is its beginning.
        let Font { mut data } = font();
        let table = |data: &[u8], tag: &[u8; 4]| {
            let entry = data.chunks(4).position(|word| word == tag).unwrap();
            u32::from_be_bytes(data[4 * entry + 8..4 * entry + 12].try_into().unwrap()) as usize
        };
        let (head, loca) = (table(&data, b"head"), table(&data, b"loca"));
        let size = if data[head + 51] == 0 { 2 } else { 4 };
        let glyph = usize::from(font().face().unwrap().glyph_index('A').unwrap().0);
        let start = loca + size * glyph;
        data.copy_within(start..start + size, start + size);
        let broken = Font::new(data).unwrap();
        let told = Lettering::new(10.0, 1.0).mesh("HAH", &broken).unwrap_err().to_string();
        assert!(told.contains("no outline of the character 'A' (U+0041)"), "{told}");
        assert!(Lettering::new(10.0, 1.0).mesh("H H", &broken).is_ok());
    }

    #[test]
    fn what_cannot_be_set_is_refused() {
        let said = |text: &str, lettering: Lettering| lettering.mesh(text, &font()).unwrap_err().to_string();
        assert!(said("\u{4e2d}", Lettering::new(1.0, 1.0)).contains("U+4E2D"));
        assert!(said("  ", Lettering::new(1.0, 1.0)).contains("nothing to be seen"));
        assert!(said("a", Lettering::new(0.0, 1.0)).contains("size"));
        assert!(said("a", Lettering::new(1.0, f64::NAN)).contains("depth"));
        assert!(Font::new(b"no font".to_vec()).unwrap_err().contains("TrueType"));
    }
}
