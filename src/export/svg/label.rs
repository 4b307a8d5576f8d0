//! Words on a map: strokes of a plotter, or text where the letters have none.

use super::sheet::trace;
use crate::export::glyphs;
use glam::DVec2;
use svg::node::element::{Group, Path, Text, Title};

/// Ink of words, and the halo around them.
const INK: &str = "#2f2b26";
const HALO: &str = "#fffdf6";
/// Size of a font as a multiple of the height of its capitals.
const FONT: f64 = 1.4;

/// Words of a height, and how wide they are.
pub(super) struct Label<'a> {
    words: &'a str,
    height: f64,
    pub width: f64,
    /// Strokes, y up from the left end of the base line; none for text, which is drawn in a font of the viewer.
    strokes: Option<Vec<Vec<DVec2>>>,
}

impl<'a> Label<'a> {
    /// Words whose capitals are `height` tall. With `has_text` those in other scripts than the Latin one are text; the viewer's
    /// fonts know how wide it is, here it is guessed.
    pub fn new(words: &'a str, height: f64, has_text: bool) -> Self {
        if has_text && !glyphs::is_latin(words) {
            // From Hangul on, letters are as wide as they are high.
            let letter = |c: char| if c >= '\u{1100}' { 1.0 } else { 0.6 };
            let width = FONT * height * words.chars().map(letter).sum::<f64>();
            return Self { words, height, width, strokes: None };
        }
        let (strokes, width) = glyphs::write(words, height);
        Self { words, height, width, strokes: Some(strokes) }
    }

    /// The words with a pale halo; `corner` is the left end of their base line.
    pub fn at(&self, corner: DVec2) -> Group {
        let group = Group::new().add(Title::new(self.words));
        let group = group.set("fill", "none").set("stroke-linecap", "round").set("stroke-linejoin", "round");
        let Some(strokes) = &self.strokes else {
            let text = Text::new(self.words).set("x", corner.x + self.width / 2.0).set("y", corner.y);
            let text = text.set("text-anchor", "middle").set("font-size", FONT * self.height);
            let text = text.set("font-family", "sans-serif").set("fill", INK).set("stroke", HALO);
            return group.add(text.set("stroke-width", self.height * 0.25).set("paint-order", "stroke"));
        };
        let mut data = String::new();
        for line in strokes {
            let line: Vec<DVec2> = line.iter().map(|p| corner + DVec2::new(p.x, -p.y)).collect();
            trace(&mut data, &line, false);
        }
        [(HALO, 0.5, 0.8), (INK, 0.14, 1.0)].into_iter().fold(group, |group, (colour, width, opacity)| {
            let path = Path::new().set("d", data.as_str()).set("stroke", colour).set("stroke-opacity", opacity);
            group.add(path.set("stroke-width", self.height * width))
        })
    }
}
