//! The one table of colours: for light paper, as in files, and for dark screens. Told apart by the colour-blind and in grey.

use super::style::Color;
use serde::{Serialize, Serializer};

/// How much of a colour is in its light areas.
pub const TINT: f64 = 0.2;

/// How much of a colour is in what is faded.
const PALE: f64 = 0.4;

/// A colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rgb(pub u8, pub u8, pub u8);

/// Colours for one kind of background.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Colors {
    /// Background.
    pub paper: Rgb,
    /// Lines and texts.
    pub ink: Rgb,
    /// What stands back.
    pub soft: Rgb,
    /// What stands far back.
    pub shade: Rgb,
    /// Lines of a grid.
    pub faint: Rgb,
    /// What is not found.
    pub alert: Rgb,
    /// From the lowest to the highest forcing level: lightness falls, or rises, steadily along it.
    pub ramp: [Rgb; 6],
    /// A few that are told apart, by lightness too.
    pub categories: [Rgb; 6],
}

/// All colours of the figures of a page.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Palette {
    /// How much of a colour is in its light areas.
    pub tint: f64,
    /// How much of a colour is in what is faded.
    pub pale: f64,
    /// On white.
    pub light: Colors,
    /// On black.
    pub dark: Colors,
}

/// All colours.
pub const PALETTE: Palette = Palette { tint: TINT, pale: PALE, light: LIGHT, dark: DARK };

/// Colours on white.
pub const LIGHT: Colors = Colors {
    paper: rgb(0xffffff),
    ink: rgb(0x1a2027),
    soft: rgb(0x5b6672),
    shade: rgb(0x8b96a1),
    faint: rgb(0xdfe4e9),
    alert: rgb(0xb3261e),
    ramp: [rgb(0xe08a2e), rgb(0xd9604f), rgb(0xbc3a72), rgb(0x8c1f8a), rgb(0x561a8f), rgb(0x1c0f63)],
    categories: [rgb(0x0072b2), rgb(0xd55e00), rgb(0x00805f), rgb(0xb0508a), rgb(0x7a3300), rgb(0x46a5dc)],
};

/// Colours on black.
pub const DARK: Colors = Colors {
    paper: rgb(0x14181d),
    ink: rgb(0xe8ecf0),
    soft: rgb(0xa3aeb9),
    shade: rgb(0x76828e),
    faint: rgb(0x2b323a),
    alert: rgb(0xff8a80),
    ramp: [rgb(0x7a5cd6), rgb(0xa457cf), rgb(0xd05fae), rgb(0xf0788a), rgb(0xfba25f), rgb(0xf7e06a)],
    categories: [rgb(0x56b4e9), rgb(0xf0913a), rgb(0x2fc39b), rgb(0xd9a0cc), rgb(0xc98f5a), rgb(0xa9c7ff)],
};

const fn rgb(hex: u32) -> Rgb {
    Rgb((hex >> 16) as u8, (hex >> 8) as u8, hex as u8)
}

impl Colors {
    /// The colour of a role.
    pub fn of(&self, color: Color) -> Rgb {
        match color {
            Color::Ink => self.ink,
            Color::Soft => self.soft,
            Color::Shade => self.shade,
            Color::Alert => self.alert,
            Color::Paper => self.paper,
            Color::Level(share) => self.along(share),
            Color::Category(index) => self.categories[index % self.categories.len()],
            Color::PaleLevel(share) => self.paper.towards(self.of(Color::Level(share)), PALE),
            Color::PaleCategory(index) => self.paper.towards(self.of(Color::Category(index)), PALE),
        }
    }

    /// The colour of a light area.
    pub fn tint(&self, color: Color) -> Rgb {
        self.paper.towards(self.of(color), TINT)
    }

    fn along(&self, share: f64) -> Rgb {
        let share = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) };
        let place = share * (self.ramp.len() - 1) as f64;
        let below = (place as usize).min(self.ramp.len() - 2);
        self.ramp[below].towards(self.ramp[below + 1], place - below as f64)
    }
}

impl Rgb {
    fn towards(self, other: Self, share: f64) -> Self {
        let mix = |a: u8, b: u8| (f64::from(a) + share * (f64::from(b) - f64::from(a))).round() as u8;
        Self(mix(self.0, other.0), mix(self.1, other.1), mix(self.2, other.2))
    }
}

impl std::fmt::Display for Rgb {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "#{:02x}{:02x}{:02x}", self.0, self.1, self.2)
    }
}

impl Serialize for Rgb {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lightness(color: Rgb) -> f64 {
        0.2126 * f64::from(color.0) + 0.7152 * f64::from(color.1) + 0.0722 * f64::from(color.2)
    }

    #[test]
    fn levels_differ_in_grey() {
        for (colors, sign) in [(LIGHT, -1.0), (DARK, 1.0)] {
            let steps = (1..=20).map(|i| {
                let at = |i: i32| lightness(colors.of(Color::Level(f64::from(i) / 20.0)));
                sign * (at(i) - at(i - 1))
            });
            assert!(steps.into_iter().all(|step| step > 0.0), "{colors:?}");
        }
    }

    #[test]
    fn colours_of_roles() {
        assert_eq!(LIGHT.of(Color::Level(0.0)).to_string(), "#e08a2e");
        assert_eq!(LIGHT.of(Color::Level(f64::NAN)).to_string(), "#e08a2e");
        assert_eq!(LIGHT.of(Color::Category(6)), LIGHT.of(Color::Category(0)));
        assert_eq!(LIGHT.of(Color::Category(0).pale()), LIGHT.paper.towards(LIGHT.of(Color::Category(0)), PALE));
        assert_eq!(LIGHT.tint(Color::Ink).to_string(), "#d1d2d4");
    }
}
