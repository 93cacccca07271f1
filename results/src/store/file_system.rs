//! What the folder of a run lies on. A database is safe with many readers where all of them see one memory: on one machine.

use std::path::Path;

/// Network file systems by the numbers that the kernel knows them by.
const OF_NETWORKS: [(u32, &str); 10] = [
    (0x6969, "NFS"),
    (0x517B, "SMB"),
    (0xFF53_4D42, "SMB"),
    (0xFE53_4D42, "SMB"),
    (0x0BD0_0BD0, "Lustre"),
    (0x4750_4653, "GPFS"),
    (0x1983_0326, "BeeGFS"),
    (0x00C3_6400, "Ceph"),
    (0x5346_414F, "AFS"),
    (0xAAD7_AAEA, "PanFS"),
];

/// Name of the network file system that a folder lies on; `None` if it lies on none that is known, or that cannot be told.
pub fn network_file_system(dir: &Path) -> Option<&'static str> {
    // Of another width, and signed, elsewhere.
    rustix::fs::statfs(dir).ok().and_then(|system| name(system.f_type as u32))
}

fn name(number: u32) -> Option<&'static str> {
    OF_NETWORKS.iter().find(|(known, _)| *known == number).map(|(_, name)| *name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_systems_have_names() {
        assert_eq!((name(0x6969), name(0xEF53)), (Some("NFS"), None));
        let here = tempfile::tempdir().unwrap();
        assert_eq!(network_file_system(here.path()), None);
        assert_eq!(network_file_system(&here.path().join("nowhere")), None);
    }
}
