//! Where isolas of a level begin below it, as fold curves say.

use super::lives::{lasting, lives};
use super::parties::next;
use crate::store::{CurvePoint, CurveRow};
use solver::response::critical::CriticalKind;

/// Where a fold curve of a branch of a level comes to a birth below that level, or else to where branches merge or part, before it turns
/// elsewhere. `amplitude` is that of the level, as typed. What is born and ends below the level is another isola, which may have merged
/// with the branch.
pub fn beginning<'c>(curves: &'c [CurveRow], amplitude: &str, branch: &str) -> Option<&'c CurvePoint> {
    let others = lives(curves);
    let crossings = curves.iter().flat_map(|curve| {
        let own =
            curve.crossings.iter().filter(|crossing| crossing.amplitude == amplitude && crossing.branch == branch);
        own.filter_map(move |crossing| Some((downhill(curve, crossing.segment)?, crossing.forcing)))
    });
    let is_others =
        |point: &CurvePoint, level: f64| others.iter().any(|life| life.from.is_at(point) && life.to.forcing < level);
    let crossings = crossings.filter(|(point, level)| !is_others(point, *level)).map(|(point, _)| point);
    let is_birth = |point: &&CurvePoint| point.event.as_deref() == Some(CriticalKind::Birth.name());
    let is_merge = |point: &&CurvePoint| point.event.as_deref() == Some(CriticalKind::Merge.name());
    let found: Vec<&CurvePoint> = crossings.filter(|point| is_birth(point) || is_merge(point)).collect();
    found.iter().find(|point| is_birth(point)).or(found.first()).copied()
}

/// Whether what begins at a point is told from there on, as an isola's story.
pub fn is_begun(curves: &[CurveRow], begins: &CurvePoint) -> bool {
    lives(curves).iter().any(|life| life.from.is_at(begins)) || lasting(curves).iter().any(|one| one.from.is_at(begins))
}

/// Where a curve turns up again, or ends, on its way down from the segment after a point.
fn downhill(curve: &CurveRow, segment: usize) -> Option<&CurvePoint> {
    let points = &curve.points;
    let is_onwards = points.get(segment + 1)?.forcing < points[segment].forcing;
    let mut i = if is_onwards { segment + 1 } else { segment };
    for _ in 0..points.len() {
        let Some((_, j)) = next(curve, i, is_onwards) else { break };
        if points[j].forcing > points[i].forcing {
            return Some(&points[i]);
        }
        i = j;
    }
    Some(&points[i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::Crossing;

    #[test]
    fn down_to_a_birth_a_merge_or_an_end() {
        let begins = |forcings: &[f64], at: usize, event: &str, segments: &[usize]| {
            let point = |(i, &forcing): (usize, &f64)| CurvePoint {
                forcing,
                omega: 1.0 + i as f64,
                event: (i == at).then(|| event.to_string()),
                ..CurvePoint::default()
            };
            let crossing =
                |&segment: &usize| Crossing { segment, forcing: 3.0, amplitude: "3".into(), branch: "isola 1".into() };
            let points = forcings.iter().enumerate().map(point).collect();
            let crossings = segments.iter().map(crossing).collect();
            let curves = [CurveRow { points, crossings, ..CurveRow::default() }];
            assert_eq!(beginning(&curves, "3", "isola 2"), None);
            assert_eq!(beginning(&curves, "3.0", "isola 1"), None);
            beginning(&curves, "3", "isola 1").map(|point| point.forcing)
        };
        let whole = [4.0, 2.0, 1.0, 2.0, 4.0];
        for segments in [&[0][..], &[3], &[0, 3]] {
            assert_eq!(begins(&whole, 2, "birth", segments), Some(1.0));
        }
        assert_eq!(begins(&whole, 2, "merge", &[0]), Some(1.0));
        assert_eq!(begins(&whole, 2, "unknown", &[0]), None);
        assert_eq!(begins(&[4.0, 2.0, 1.0], 2, "birth", &[0]), Some(1.0));
        assert_eq!(begins(&[4.0, 2.0, 1.0], 5, "birth", &[0]), None, "it is not followed to where it begins");
        // One of its folds leads nowhere.
        assert_eq!(begins(&[1.0, 4.0, 2.0, 0.5, 2.0], 3, "birth", &[0, 1]), Some(0.5));
    }
    /// An isola that is born and has merged with another one below the level is not the one of the level.
    #[test]
    fn what_has_ended_below_the_level_is_another_isola() {
        let events = [(1.0, None), (4.0, Some("merge")), (1.5, Some("birth")), (5.0, None)];
        let point = |(i, &(forcing, event)): (usize, &(f64, Option<&str>))| CurvePoint {
            forcing,
            omega: 1.0 + i as f64,
            event: event.map(str::to_string),
            ..CurvePoint::default()
        };
        let begins = |level: f64| {
            let points = events.iter().enumerate().map(point).collect();
            let (amplitude, branch) = (level.to_string(), "isola 1".to_string());
            let crossings = vec![Crossing { segment: 2, forcing: level, amplitude: amplitude.clone(), branch }];
            let curves = [CurveRow { points, crossings, ..CurveRow::default() }];
            beginning(&curves, &amplitude, "isola 1").map(|point| point.forcing)
        };
        assert_eq!([begins(3.0), begins(4.5)], [Some(1.5), None]);
    }
}
