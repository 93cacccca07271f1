//! Reasons below a table, each once, and lines that are not too long.

/// Most places that a text names.
const PLACES: usize = 3;

/// Digits of marks.
const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];

/// Texts with numbers, from 1.
#[derive(Debug, Default)]
pub(super) struct Footnotes {
    texts: Vec<Note>,
}

/// A text with the places that it is about.
#[derive(Debug)]
struct Note {
    text: String,
    places: Vec<String>,
    /// The file that has all of them.
    file: &'static str,
}

impl Footnotes {
    /// The mark of a text: its number, raised. The same text has the same mark.
    pub(super) fn mark(&mut self, text: String) -> String {
        raised(self.index(text) + 1)
    }

    /// The same of a text that is about several places, all of which are in a file: it names some of them.
    pub(super) fn mark_at(&mut self, text: String, place: String, file: &'static str) -> String {
        let index = self.index(text);
        self.texts[index].places.push(place);
        self.texts[index].file = file;
        raised(index + 1)
    }

    fn index(&mut self, text: String) -> usize {
        self.texts.iter().position(|other| other.text == text).unwrap_or_else(|| {
            self.texts.push(Note { text, places: Vec::new(), file: "" });
            self.texts.len() - 1
        })
    }

    /// The texts with their marks, in lines of this width.
    pub(super) fn lines(&self, width: u16) -> Vec<String> {
        let line = |(i, note): (usize, &Note)| wrapped(&format!("{} {note}", raised(i + 1)), width, "  ");
        self.texts.iter().enumerate().map(line).collect()
    }
}

impl std::fmt::Display for Note {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.text)?;
        match self.places.len() {
            0 => Ok(()),
            all if all <= PLACES => write!(f, " ({})", self.places.join("; ")),
            all => write!(f, " ({}; and {} more: {})", self.places[..PLACES].join("; "), all - PLACES, self.file),
        }
    }
}

/// A text with another mark at its end, apart from one that is there already: two digits would be one number.
pub(super) fn with_mark(text: &str, mark: &str) -> String {
    let is_marked = text.ends_with(RAISED) && mark.starts_with(RAISED);
    format!("{text}{}{mark}", if is_marked { " " } else { "" })
}

fn raised(number: usize) -> String {
    number.to_string().bytes().map(|digit| RAISED[usize::from(digit - b'0')]).collect()
}

/// Breaks a text between words so that no line has more characters than `width`, a longer word apart; all lines but the
/// first begin with `indent`.
pub fn wrapped(text: &str, width: u16, indent: &str) -> String {
    let mut lines: Vec<String> = Vec::new();
    let mut line = String::new();
    for word in text.split(' ') {
        let is_begun = !line.trim().is_empty();
        if is_begun && line.chars().count() + 1 + word.chars().count() > usize::from(width) {
            lines.push(std::mem::replace(&mut line, format!("{indent}{word}")));
        } else {
            line += if is_begun { " " } else { "" };
            line += word;
        }
    }
    lines.push(line);
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_reason_has_one_note() {
        let mut notes = Footnotes::default();
        let marks = ["stalled", "reversed", "stalled"].map(|text| notes.mark(text.into()));
        assert_eq!(marks, ["¹", "²", "¹"]);
        assert_eq!(notes.lines(80), ["¹ stalled", "² reversed"]);
        assert_eq!(raised(120), "¹²⁰");
        assert_eq!(["1.5", "1.5³"].map(|text| with_mark(text, "⁵")), ["1.5⁵", "1.5³ ⁵"]);
        assert_eq!(with_mark("1.5³", ""), "1.5³");
    }

    #[test]
    fn places_of_one_reason_stand_behind_it() {
        let mut notes = Footnotes::default();
        let marks = [1, 2].map(|a| notes.mark_at("not found".into(), format!("A = {a}"), "windows.csv"));
        assert_eq!((marks, notes.lines(80)), (["¹", "¹"].map(String::from), vec!["¹ not found (A = 1; A = 2)".into()]));
        (3..6).for_each(|a| drop(notes.mark_at("not found".into(), format!("A = {a}"), "windows.csv")));
        assert_eq!(notes.lines(80), ["¹ not found (A = 1; A = 2; A = 3; and 2 more: windows.csv)"]);
    }

    #[test]
    fn lines_break_between_words() {
        assert_eq!(wrapped("a window that is not found", 12, "  "), "a window\n  that is\n  not found");
        assert_eq!(wrapped("short", 12, "  "), "short");
        assert_eq!(wrapped("a runs/with-a-long-name", 8, ""), "a\nruns/with-a-long-name");
    }
}
