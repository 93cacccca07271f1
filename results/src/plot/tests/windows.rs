//! Figures of one forcing amplitude.

use super::{damper, labels, sheet};
use crate::plot::sheet::Sheet;

#[test]
fn figures_of_the_backbone_show_windows() {
    let dir = damper();
    let run = dir.path().join("run");
    for figure in ["balance", "backbone"] {
        let drawn = sheet(&run, &["--figure", figure]).unwrap();
        assert_eq!(labels(&drawn, 0), ["main", "isola 1"], "{figure}");
        let drawn = sheet(&run, &["--figure", figure, "--amplitude", "0.003"]).unwrap();
        assert_eq!(labels(&drawn, 0), ["main"], "{figure}");
        // The balance is that of any forcing amplitude.
        let drawn = sheet(&run, &["--figure", figure, "--amplitude", "0.0061"]).unwrap();
        assert_eq!(labels(&drawn, 0), ["window 1", "window 2"], "{figure}");
        assert_eq!(drawn.figure.title.unwrap(), "windows at A = 0.0061 (not a level of this run)");
    }
    let over = |quantity| sheet(&run, &["--figure", "balance", "--along", quantity]).map(heading).unwrap();
    fn heading(sheet: Sheet) -> String {
        sheet.figure.panels[0].axes(sheet.choice).unwrap().0.heading()
    }
    assert_eq!(over("omega"), "frequency ω (rad/s)");
    assert_eq!(over("amplitude"), "amplitude of x1 (m)");
}
