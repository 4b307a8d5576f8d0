//! A plotter's alphabet: capitals, digits and a few signs as strokes, so that names need no font on the machine. Names in other
//! scripts are spelled in Latin letters.

use glam::DVec2;

/// Height of capitals, in the units of the strokes.
const CAP: f64 = 6.0;
/// Space after a glyph.
const GAP: f64 = 2.0;

/// Strokes of a glyph, separated by commas. Each point is two digits: x, and y up from the base line.
fn strokes(letter: char) -> &'static str {
    match letter {
        'A' => "002640,1232",
        'B' => "00063645443303,3342413000",
        'C' => "4536160501103041",
        'D' => "00062644422000",
        'E' => "46060040,0333",
        'F' => "460600,0333",
        'G' => "45361605011030414323",
        'H' => "0006,4046,0343",
        'I' => "0006",
        'J' => "3631201001",
        'K' => "0006,460340",
        'L' => "060030",
        'M' => "0006234640",
        'N' => "00064046",
        'O' | '0' => "100105163645413010",
        'P' => "00063645443303",
        'Q' => "100105163645413010,2240",
        'R' => "00063645443303,2340",
        'S' => "453616050413334241301001",
        'T' => "0646,2620",
        'U' => "060110304146",
        'V' => "062046",
        'W' => "0610243046",
        'X' => "0046,0640",
        'Y' => "062346,2320",
        'Z' => "06460040",
        '1' => "051610",
        '2' => "05163645440040",
        '3' => "05163645443313,334241301001",
        '4' => "30360242",
        '5' => "460604344341301001",
        '6' => "4536160501103041423303",
        '7' => "064610",
        '8' => "13040516364544331302011030414233",
        '9' => "0110304145361605041343",
        'k' => "0006,3402,1330",
        'm' => "0004,03142320,23344340",
        '-' => "0333",
        '+' => "0333,1521",
        '/' => "0026",
        ',' => "0111",
        ':' => "0000,0404",
        '\'' => "0605",
        '.' => "0000",
        '&' => "40051626350201102042",
        '(' => "16050110",
        ')' => "06151100",
        '"' => "0605,1615",
        '!' => "0602,0000",
        '?' => "0516354422,2000",
        _ => "",
    }
}

/// Whether all letters are Latin ones, with or without accents: what the strokes show.
pub(crate) fn is_latin(text: &str) -> bool {
    let is_latin =
        |c: char| c.is_ascii() || ('\u{a0}'..='\u{24f}').contains(&c) || ('\u{1e00}'..='\u{1eff}').contains(&c);
    // Accents may stand by themselves, as may the typographer's signs.
    let is_sign = |c: char| ('\u{300}'..='\u{36f}').contains(&c) || ('\u{2010}'..='\u{203a}').contains(&c);
    text.chars().all(|c| is_latin(c) || is_sign(c))
}

/// A text in plain Latin letters: without accents, and other scripts spelled as they sound.
pub(crate) fn spelled(text: &str) -> String {
    let composed = text.replace(|c| ('\u{300}'..='\u{36f}').contains(&c), "");
    deunicode::deunicode_with_tofu(&composed, "").trim().to_owned()
}

/// The text in the letters that have strokes: capitals, but for the `km` and `m` of a scale.
fn capitals(text: &str) -> String {
    let is_length = |(number, unit): (&str, &str)| number.parse::<f64>().is_ok() && matches!(unit, "km" | "m");
    if text.split_once(' ').is_some_and(is_length) { text.to_owned() } else { spelled(text).to_uppercase() }
}

/// Strokes of `text` with capitals `height` tall, y up, the left end of the base line at (0, 0), and the text's width.
/// The text is [`spelled`] in Latin capitals; signs without strokes leave a gap.
pub(crate) fn write(text: &str, height: f64) -> (Vec<Vec<DVec2>>, f64) {
    let unit = height / CAP;
    let (mut lines, mut x) = (Vec::new(), 0.0);
    for letter in capitals(text).chars() {
        let mut width: f64 = 0.0;
        for stroke in strokes(letter).split(',').filter(|s| !s.is_empty()) {
            let digit = |b: u8| f64::from(b - b'0');
            let points = stroke.as_bytes().chunks_exact(2).map(|p| DVec2::new(digit(p[0]), digit(p[1])));
            width = points.clone().map(|p| p.x).fold(width, f64::max);
            lines.push(points.map(|p| (p + DVec2::X * x) * unit).collect());
        }
        x += if strokes(letter).is_empty() { GAP } else { width + GAP };
    }
    (lines, (x - GAP).max(0.0) * unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_script_has_a_spelling() {
        for (name, expected) in [
            ("\u{41c}\u{43e}\u{441}\u{43a}\u{432}\u{430}", "Moskva"),
            ("\u{6771}\u{4eac}", "Dong Jing"),
            ("Tp. H\u{1ed3}", "Tp. Ho"),
            ("Tp. Ho\u{302}\u{300}", "Tp. Ho"),
            ("\u{c5}\u{142}\u{f8} L\u{2019}\u{c9}cluse", "Alo L'Ecluse"),
            ("Sample & Sons (East)", "Sample & Sons (East)"),
        ] {
            assert_eq!(spelled(name), expected);
            let shown = capitals(name).chars().filter(|c| !c.is_whitespace()).all(|c| !strokes(c).is_empty());
            assert!(shown, "{name}");
        }
        assert!(
            is_latin("Tp. H\u{1ed3}")
                && is_latin("Sm\u{f8}r\u{2013}\u{142}")
                && !is_latin("\u{6771}")
                && !is_latin("A \u{411}")
        );
        assert_eq!(
            (capitals("500 m"), capitals("2 km"), capitals("Ham")),
            ("500 m".into(), "2 km".into(), "HAM".into())
        );
    }

    #[test]
    fn every_capital_and_digit_has_strokes_within_its_box() {
        for letter in ('A'..='Z').chain('0'..='9') {
            let (lines, width) = write(&letter.to_string(), 12.0);
            assert!(!lines.is_empty() && width <= 8.0, "{letter}");
            let inside = |p: &DVec2| (0.0..=width).contains(&p.x) && (0.0..=12.0).contains(&p.y);
            assert!(lines.iter().all(|l: &Vec<DVec2>| l.len() > 1 && l.iter().all(inside)), "{letter}");
        }
    }
}
