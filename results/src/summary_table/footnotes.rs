//! Reasons below a table, each once, and lines that are not too long.

/// Texts with numbers, from 1.
#[derive(Debug, Default)]
pub(super) struct Footnotes {
    texts: Vec<String>,
}

impl Footnotes {
    /// The mark of a text: its number, raised. The same text has the same mark.
    pub(super) fn mark(&mut self, text: String) -> String {
        let known = self.texts.iter().position(|other| *other == text);
        let index = known.unwrap_or_else(|| {
            self.texts.push(text);
            self.texts.len() - 1
        });
        raised(index + 1)
    }

    /// The texts with their marks, in lines of this width.
    pub(super) fn lines(&self, width: u16) -> Vec<String> {
        let line = |(i, text): (usize, &String)| wrapped(&format!("{} {text}", raised(i + 1)), width, "  ");
        self.texts.iter().enumerate().map(line).collect()
    }
}

fn raised(number: usize) -> String {
    let digits = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    number.to_string().bytes().map(|digit| digits[usize::from(digit - b'0')]).collect()
}

/// Breaks a text between words so that no line has more characters than `width`, a longer word apart; all lines but the
/// first begin with `indent`.
pub(super) fn wrapped(text: &str, width: u16, indent: &str) -> String {
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
    }

    #[test]
    fn lines_break_between_words() {
        assert_eq!(wrapped("a window that is not found", 12, "  "), "a window\n  that is\n  not found");
        assert_eq!(wrapped("short", 12, "  "), "short");
        assert_eq!(wrapped("a runs/with-a-long-name", 8, ""), "a\nruns/with-a-long-name");
    }
}
