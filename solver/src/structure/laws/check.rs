//! Gradient checker used by every law: exact first and second derivatives against central differences at randomised
//! states.

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

    fn state(&mut self, scales: &Scales) -> (Instant, Before) {
        let now = Instant {
            u: scales.u.map(|scale| self.next(scale)),
            v: scales.v.map(|scale| self.next(scale)),
            speed: self.next(scales.speed),
        };
        (now, Before { u: self.next(scales.u[0]), force: self.next(scales.force) })
    }
}

/// Panics unless every first and second derivative of `law` agrees with central differences, and unless entries outside
/// its pattern (and memory derivatives of a law without memory) are zero.
pub fn check_gradients(law: &impl Law, scales: &Scales) {
    law.validate().unwrap();
    let (mut states, mut directions) = (Sequence(1), Sequence(2));
    for _ in 0..500 {
        let (now, before) = states.state(scales);
        check_state(law, scales, &now, &before);
        let (along, before_along) = directions.state(scales);
        check_along(law, scales, (&now, &before), (&along, &before_along));
    }
}

fn check_state(law: &impl Law, scales: &Scales, now: &Instant, before: &Before) {
    let response = law.respond(now, before);
    check_zeros(law, &response);
    if law.is_odd() {
        let mirrored = Instant { u: now.u.map(|u| -u), v: now.v.map(|v| -v), ..*now };
        let mirrored_before = Before { u: -before.u, force: -before.force };
        assert_eq!(law.respond(&mirrored, &mirrored_before).force, response.force.map(|force| -force));
    }
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

/// Second derivatives in one direction: central differences of all that the law responds.
fn check_along(law: &impl Law, scales: &Scales, at: (&Instant, &Before), direction: (&Instant, &Before)) {
    const STEP: f64 = 1e-6;
    let moved = |step: f64| {
        let ((now, before), (along, before_along)) = (at, direction);
        let add = |x: [f64; MAX_ARGUMENTS], d: [f64; MAX_ARGUMENTS]| std::array::from_fn(|i| x[i] + step * d[i]);
        let now = Instant { u: add(now.u, along.u), v: add(now.v, along.v), speed: now.speed + step * along.speed };
        let force = before.force + step * before_along.force;
        entries(&law.respond(&now, &Before { u: before.u + step * before_along.u, force }))
    };
    let exact = entries(&law.respond_along(at.0, at.1, direction.0, direction.1));
    let (plus, minus, sizes) = (moved(STEP), moved(-STEP), entries(&units(scales)));
    for (i, exact) in exact.iter().enumerate() {
        let difference = (plus[i] - minus[i]) / (2.0 * STEP);
        // Truncation 1e-12 times the third derivatives (up to 1e4 in these units), rounding 1e-10.
        let size = exact.abs().max(sizes[i]);
        assert!(
            (exact - difference).abs() < 1e-6 * size,
            "entry {i} along {direction:?}: {exact} against {difference}"
        );
    }
}

/// Forces and derivatives in a row.
fn entries(response: &Response) -> Vec<f64> {
    let Response { force, du, dv, dspeed, du_before, dforce_before } = response;
    let matrices = du.iter().chain(dv).flatten();
    force.iter().chain(matrices).chain(dspeed).chain([du_before, dforce_before]).copied().collect()
}

/// The orders of magnitude of forces and derivatives.
fn units(scales: &Scales) -> Response {
    Response {
        force: [scales.force; MAX_ARGUMENTS],
        du: [scales.u.map(|u| scales.force / u); MAX_ARGUMENTS],
        dv: [scales.v.map(|v| scales.force / v); MAX_ARGUMENTS],
        dspeed: [scales.force / scales.speed; MAX_ARGUMENTS],
        du_before: scales.force / scales.u[0],
        dforce_before: 1.0,
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
