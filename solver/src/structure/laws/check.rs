//! Gradient checker used by every law: exact derivatives against central differences at randomised states.

use super::{Before, Instant, Law, MAX_ARGUMENTS, Pattern, Response};

/// Orders of magnitude of a law's inputs: states are drawn in ± these values.
pub struct Scales {
    pub u: [f64; MAX_ARGUMENTS],
    pub v: [f64; MAX_ARGUMENTS],
    pub speed: f64,
    pub force: f64,
}

/// One input of a law.
#[derive(Debug, Clone, Copy)]
enum Input {
    Displacement(usize),
    Velocity(usize),
    Speed,
    DisplacementBefore,
    ForceBefore,
}

/// SplitMix64: a fixed sequence, so that no state ever falls on a kink by chance.
struct Sequence(u64);

impl Sequence {
    /// Next number, uniform in ±`scale`.
    fn next(&mut self, scale: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        scale * ((z ^ (z >> 31)) as f64 / u64::MAX as f64 * 2.0 - 1.0)
    }
}

/// Panics unless every derivative of `law` agrees with central differences, and unless entries outside its pattern
/// (and memory derivatives of a law without memory) are zero.
pub fn check_gradients(law: &impl Law, scales: &Scales) {
    law.validate().unwrap();
    let mut sequence = Sequence(1);
    for _ in 0..500 {
        let now = Instant {
            u: scales.u.map(|scale| sequence.next(scale)),
            v: scales.v.map(|scale| sequence.next(scale)),
            speed: sequence.next(scales.speed),
        };
        let before = Before { u: sequence.next(scales.u[0]), force: sequence.next(scales.force) };
        check_state(law, scales, &now, &before);
    }
}

fn check_state(law: &impl Law, scales: &Scales, now: &Instant, before: &Before) {
    let response = law.respond(now, before);
    check_zeros(law, &response);
    let mut inputs = vec![Input::Speed, Input::DisplacementBefore, Input::ForceBefore];
    for j in 0..MAX_ARGUMENTS {
        inputs.extend([Input::Displacement(j), Input::Velocity(j)]);
    }
    for input in inputs {
        let scale = match input {
            Input::Displacement(j) => scales.u[j],
            Input::Velocity(j) => scales.v[j],
            Input::Speed => scales.speed,
            Input::DisplacementBefore => scales.u[0],
            Input::ForceBefore => scales.force,
        };
        let step = 1e-5 * scale;
        let (plus, minus) = (shifted(law, now, before, input, step), shifted(law, now, before, input, -step));
        for i in 0..MAX_ARGUMENTS {
            let exact = match input {
                Input::Displacement(j) => response.du[i][j],
                Input::Velocity(j) => response.dv[i][j],
                Input::Speed => response.dspeed[i],
                Input::DisplacementBefore if i == 0 => response.du_before,
                Input::ForceBefore if i == 0 => response.dforce_before,
                _ => 0.0,
            };
            let difference = (plus.force[i] - minus.force[i]) / (2.0 * step);
            // Truncation 1e-10 times the law's curvature (up to 100 in these units), rounding 1e-11.
            let size = exact.abs().max(scales.force / scale);
            assert!((exact - difference).abs() < 1e-7 * size, "∂f{i}/∂{input:?}: {exact} against {difference}");
        }
    }
}

fn check_zeros(law: &impl Law, response: &Response) {
    let mut nonzero = Pattern::default();
    for i in 0..MAX_ARGUMENTS {
        for j in 0..MAX_ARGUMENTS {
            nonzero.du[i][j] = response.du[i][j] != 0.0;
            nonzero.dv[i][j] = response.dv[i][j] != 0.0;
            assert!(!nonzero.du[i][j] || law.pattern().du[i][j], "∂f{i}/∂u{j} is outside the pattern");
            assert!(!nonzero.dv[i][j] || law.pattern().dv[i][j], "∂f{i}/∂v{j} is outside the pattern");
        }
        assert!(i < law.arguments() || response.force[i] == 0.0, "force {i} of {}", law.arguments());
    }
    let memory = response.du_before != 0.0 || response.dforce_before != 0.0;
    assert!(!memory || law.has_memory(), "a law without memory has memory derivatives");
}

fn shifted(law: &impl Law, now: &Instant, before: &Before, input: Input, step: f64) -> Response {
    let (mut now, mut before) = (*now, *before);
    match input {
        Input::Displacement(j) => now.u[j] += step,
        Input::Velocity(j) => now.v[j] += step,
        Input::Speed => now.speed += step,
        Input::DisplacementBefore => before.u += step,
        Input::ForceBefore => before.force += step,
    }
    law.respond(&now, &before)
}
