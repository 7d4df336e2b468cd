//! The numbers of a sketch file in its text, so that a change by hand is written there.

use moldloft_sketch::SketchObject;
use std::collections::BTreeMap;
use std::ops::Range;

/// Where the commands of a file state the numbers of its objects.
#[derive(Debug, Default)]
pub struct NumberPlaces {
    /// By the name of the object and the key of the number.
    places: BTreeMap<(String, String), Range<usize>>,
    /// Numbers of each object after the last line.
    counted: BTreeMap<String, usize>,
}

impl NumberPlaces {
    /// Takes in a line of the text, `start` bytes from its beginning, after which `object` is the
    /// active one: it states numbers that are new, and those that it names.
    pub fn take(&mut self, object: &SketchObject, line: &str, start: usize) {
        let words: Vec<(usize, &str)> = line
            .split(|c: char| c.is_whitespace() || c == '=')
            .map(|word| (word.as_ptr() as usize - line.as_ptr() as usize, word))
            .filter(|(_, word)| !word.is_empty())
            .collect();
        if !words.iter().any(|(_, word)| word.starts_with(|c: char| c.is_ascii_digit() || c == '-'))
        {
            return;
        }
        let count = object.variables.len() + object.dimensions.len();
        let more = self.counted.insert(object.name.clone(), count) != Some(count);
        for (key, name, value) in literals(object) {
            let place = (object.name.clone(), key.clone());
            let named = words.iter().any(|(_, word)| word.eq_ignore_ascii_case(name));
            if !(named || more && !self.places.contains_key(&place)) {
                continue;
            }
            let behind = line.find('=').unwrap_or(0);
            let states = |word: &str| word.parse::<f64>().is_ok_and(|x| x == value);
            let mut stated = words.iter().filter(|(at, word)| *at >= behind && states(word));
            let found = if behind > 0 { stated.next() } else { stated.next_back() };
            if let Some((at, word)) = found {
                self.places.insert(place, start + at..start + at + word.len());
            }
        }
    }

    /// The bytes of `text` that state a number of an object as its value.
    pub fn of(&self, object: &str, key: &str, value: f64, text: &str) -> Option<Range<usize>> {
        let range = self.places.get(&(object.to_owned(), key.to_owned()))?;
        let stated = text.get(range.clone())?.parse::<f64>().is_ok_and(|x| x == value);
        stated.then(|| range.clone())
    }
}

/// The key, name and value of each plain number of an object.
pub fn literals(object: &SketchObject) -> impl Iterator<Item = (&String, &String, f64)> {
    let variables =
        (object.variables.iter()).filter_map(|(key, v)| Some((key, &v.name, v.value.literal()?)));
    let dimensions = (object.dimensions.iter())
        .filter_map(|(key, d)| Some((key, &d.name, d.value.as_ref()?.literal()?)));
    variables.chain(dimensions)
}
