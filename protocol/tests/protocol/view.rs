//! MessagePack bytes for people: one field a line, every number with its type on the wire.

use std::fmt::Write;

/// All of `bytes`, which hold one value.
pub fn view(bytes: &[u8]) -> String {
    let mut reader = Reader { bytes, out: String::new() };
    reader.value(0);
    assert!(reader.bytes.is_empty(), "{} bytes left", reader.bytes.len());
    reader.out
}

struct Reader<'b> {
    bytes: &'b [u8],
    out: String,
}

impl<'b> Reader<'b> {
    fn take(&mut self, count: usize) -> &'b [u8] {
        let (taken, rest) = self.bytes.split_at(count);
        self.bytes = rest;
        taken
    }

    fn number(&mut self, width: usize) -> u64 {
        self.take(width).iter().fold(0, |number, &byte| number << 8 | u64::from(byte))
    }

    fn value(&mut self, depth: usize) {
        let head = self.take(1)[0];
        let text = match head {
            0x00..=0x7f => format!("{head} int"),
            0x80..=0x8f => return self.map(usize::from(head & 0x0f), depth),
            0x90..=0x9f => return self.sequence(usize::from(head & 0x0f), depth),
            0xa0..=0xbf => self.text(usize::from(head & 0x1f)),
            0xc0 => "nil".into(),
            0xc2 => "false".into(),
            0xc3 => "true".into(),
            0xc4..=0xc6 => {
                let length = self.number(1 << (head - 0xc4)) as usize;
                let bytes = self.take(length);
                bytes.iter().fold(format!("{length} bytes"), |text, byte| format!("{text} {byte:02x}"))
            }
            0xcb => format!("{:?} f64", f64::from_bits(self.number(8))),
            0xcc..=0xcf => format!("{} u{}", self.number(1 << (head - 0xcc)), 8 << (head - 0xcc)),
            0xd9..=0xdb => {
                let length = self.number(1 << (head - 0xd9)) as usize;
                self.text(length)
            }
            0xdc | 0xdd => {
                let count = self.number(2 << (head - 0xdc)) as usize;
                return self.sequence(count, depth);
            }
            0xde | 0xdf => {
                let count = self.number(2 << (head - 0xde)) as usize;
                return self.map(count, depth);
            }
            0xe0..=0xff => format!("{} int", head as i8),
            _ => panic!("type {head:#x} is not used"),
        };
        self.out.push_str(&text);
    }

    fn text(&mut self, length: usize) -> String {
        format!("{:?}", std::str::from_utf8(self.take(length)).expect("UTF-8"))
    }

    fn map(&mut self, count: usize, depth: usize) {
        write!(self.out, "map {count}").expect("a string takes everything");
        for _ in 0..count {
            self.indent(depth);
            self.value(depth + 1);
            self.out.push_str(": ");
            self.value(depth + 1);
        }
    }

    fn sequence(&mut self, count: usize, depth: usize) {
        write!(self.out, "array {count}").expect("a string takes everything");
        for _ in 0..count {
            self.indent(depth);
            self.out.push_str("- ");
            self.value(depth + 1);
        }
    }

    fn indent(&mut self, depth: usize) {
        self.out.push('\n');
        self.out.push_str(&"  ".repeat(depth + 1));
    }
}
