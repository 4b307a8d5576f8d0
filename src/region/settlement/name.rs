//! Names of settlements, made from syllables.

use crate::network::SizeClass;
use crate::space::Stream;

const ONSETS: [&str; 32] = [
    "b", "br", "c", "cl", "cr", "d", "dr", "f", "fl", "g", "gl", "gr", "h", "k", "l", "m", "n", "p", "r", "s", "sh",
    "st", "str", "sw", "t", "th", "tr", "v", "w", "wh", "", "",
];
const VOWELS: [&str; 11] = ["a", "a", "e", "e", "i", "o", "o", "u", "ea", "ai", "oa"];
const CODAS: [&str; 22] = [
    "l", "ll", "n", "nd", "m", "r", "rn", "s", "st", "t", "th", "ck", "x", "lm", "ld", "ng", "v", "b", "d", "sk", "",
    "",
];
const ENDINGS: [&str; 30] = [
    "ton", "ham", "ford", "bury", "wick", "ley", "stead", "mere", "field", "wood", "by", "thorpe", "dale", "worth",
    "combe", "bridge", "well", "stow", "brook", "den", "hurst", "minster", "mouth", "port", "burgh", "holm", "gate",
    "ness", "cote", "over",
];
const BEFORE: [&str; 9] = ["Upper", "Lower", "Great", "Little", "Old", "North", "East", "West", "Long"];
const AFTER: [&str; 6] = ["Green", "Cross", "End", "Hill", "Heath", "Common"];

fn pick<'a>(stream: &mut Stream, from: &[&'a str]) -> &'a str {
    from[stream.index(from.len())]
}

/// A name for a settlement of a size.
pub(super) fn settlement_name(stream: &mut Stream, size: SizeClass) -> String {
    let mut root = String::new();
    let syllables = if stream.chance(0.2) { 2 } else { 1 };
    for i in 0..syllables {
        // Inside a name, neither two vowels nor many consonants meet.
        let onset = loop {
            let onset = pick(stream, &ONSETS);
            if i == 0 || onset.len() == 1 {
                break onset;
            }
        };
        root.push_str(onset);
        root.push_str(pick(stream, &VOWELS));
        let coda = pick(stream, &CODAS);
        if i + 1 == syllables {
            root.push_str(coda);
        }
    }
    let ending = pick(stream, &ENDINGS);
    // "Horham", not "Horhham"; "Stowick", not "Stowwick".
    if ending.chars().next() == root.chars().last() {
        root.pop();
    }
    root.push_str(ending);
    let first = root.chars().next().map(|c| c.to_uppercase().to_string()).unwrap_or_default();
    let name = first + root.get(1..).unwrap_or_default();
    match size {
        SizeClass::Village if stream.chance(0.18) => format!("{} {name}", pick(stream, &BEFORE)),
        SizeClass::Village | SizeClass::Town if stream.chance(0.1) => format!("{name} {}", pick(stream, &AFTER)),
        _ => name,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Seed;

    #[test]
    fn names_are_words_and_seldom_the_same() {
        let mut names: Vec<String> =
            (0..2000).map(|i| settlement_name(&mut Seed(4).stream("test", &[i]), SizeClass::Village)).collect();
        for name in &names {
            assert!((4..=24).contains(&name.len()), "{name}");
            assert!(name.split(' ').all(|w| w.chars().next().is_some_and(char::is_uppercase)), "{name}");
        }
        names.sort();
        names.dedup();
        assert!(names.len() > 1800, "{}", names.len());
    }
}
