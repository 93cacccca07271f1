//! Small deviations of marched orbits at random points grow as their multipliers say.

use super::common::{BACKWARD, FRICTIONLESS, Scenario, assert_close};
use super::stability::{isola, polished};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use solver::linalg::Matrix;
use solver::stability::polish::Polished;

/// Points that are looked at. Of fifty one was not met by Newton's method without its neighbour; growth differed by 1.1e-6 at most.
const POINTS: usize = 12;
/// Periods of the tangent after which the leading direction, or pair of them, is all that is left.
const SETTLING: usize = 3000;
/// Periods over which growth is measured.
const COUNT: usize = 20;
/// Size of a deviation, in shares of the motion: grown by 1.2 a period it stays small.
const SHARE: f64 = 1e-7;

fn size(values: &[f64]) -> f64 {
    values.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// A deviation after many periods of the tangent, of size 1, and its growth a period over the second half of them.
fn leading(tangent: &Matrix, start: Vec<f64>) -> (Vec<f64>, f64) {
    let (mut deviation, mut growth) = (start, 0.0);
    for period in 0..2 * SETTLING {
        deviation = tangent.mul_vec(&deviation);
        let length = size(&deviation);
        deviation.iter_mut().for_each(|x| *x /= length);
        growth += if period < SETTLING { 0.0 } else { length.ln() / SETTLING as f64 };
    }
    (deviation, growth.exp())
}

/// Growth a period of a deviation in the marched motion and by the tangent, and by the latter over thousands of periods.
fn growths(scenario: &Scenario, found: &Polished, random: &mut ChaCha8Rng) -> [f64; 3] {
    let mut marching = found.orbit.marching(scenario.model()).unwrap();
    let mut along = found.orbit.marching(scenario.model()).unwrap();
    let tangent = marching.monodromy().unwrap();
    let start: Vec<f64> = found.orbit.state.iter().map(|x| x * random.gen_range(-1.0..1.0)).collect();
    let (direction, growth) = leading(&tangent, start);
    let scale = SHARE * size(&found.orbit.state);
    let moved: Vec<f64> = found.orbit.state.iter().zip(&direction).map(|(x, d)| x + scale * d).collect();
    marching.restart(&moved).unwrap();
    for _ in 0..COUNT {
        marching.period().unwrap();
        // What the orbit misses of its begin grows as well.
        along.period().unwrap();
    }
    let left: Vec<f64> = marching.state().iter().zip(along.state()).map(|(a, b)| (a - b) / scale).collect();
    let told = (0..COUNT).fold(direction, |deviation, _| tangent.mul_vec(&deviation));
    let root = |grown: f64| grown.powf(1.0 / COUNT as f64);
    [root(size(&left)), root(size(&told)), growth]
}

#[test]
fn deviations_grow_as_the_multipliers_say_at_random_points() {
    let branches = [
        (&FRICTIONLESS, isola(&FRICTIONLESS, 60, 2623.0)),
        (&FRICTIONLESS, FRICTIONLESS.level(60).main()),
        (&BACKWARD, isola(&BACKWARD, 20, 2474.0)),
    ];
    let mut random = ChaCha8Rng::seed_from_u64(67);
    let (mut errors, mut lost) = (Vec::new(), 0);
    for number in 0..POINTS {
        let (scenario, branch) = branches[number % branches.len()];
        let index = random.gen_range(1..branch.points.len() - 1);
        let polish = polished(scenario, branch, index as isize);
        let Some(found) = &polish.polished else {
            println!("{} rad/s: {:?}", branch.points[index].omega(), polish.reason);
            lost += 1;
            continue;
        };
        let modulus = found.multipliers[0].modulus();
        let [marched, told, lasting] = growths(scenario, found, &mut random);
        let error = (marched / told - 1.0).abs();
        println!(
            "{} rad/s: {marched}, {error:.1e} from the tangent; {lasting} at last, |μ| = {modulus}",
            found.orbit.omega
        );
        assert!(error < if modulus > 1.1 { 6e-3 } else { 1e-3 }, "{marched} {told}");
        assert_close(lasting, modulus, 1e-3, "growth a period");
        errors.push(error);
    }
    errors.sort_by(f64::total_cmp);
    println!("median {:e}, largest {:e}, lost {lost}", errors[errors.len() / 2], errors[errors.len() - 1]);
    assert!(lost * 10 <= POINTS, "{lost} lost");
}
