//! Figures of Kämpe, Sintorn, Assarsson 2015, "Fast, memory-efficient construction of voxelized shadows" (I3D 2015), tables
//! 1 to 4, measured on an Intel Core i5 2500K and an NVIDIA GTX Titan. Sintorn et al. 2014 as cited there.

/// A time as the paper has it: in whole milliseconds below a second, in tenths of a second from there on.
pub fn time(seconds: f64) -> String {
    if seconds < 1.0 { format!("{:.0} ms", 1e3 * seconds) } else { format!("{seconds:.1} s") }
}

/// Resolutions of the tables' columns.
pub const RESOLUTIONS: [u32; 7] = [4096, 8192, 16_384, 32_768, 65_536, 131_072, 262_144];

/// A row of table 1: Closed City.
pub struct Culling {
    pub interior: &'static str,
    /// Whether identical nodes are culled.
    pub culling: bool,
    /// Seconds of the whole construction.
    pub total: [f64; 7],
    /// Of it, of inserting and merging nodes.
    pub insert_merge: [f64; 7],
}

pub const TABLE_1: [Culling; 4] = [
    Culling {
        interior: "open",
        culling: false,
        total: [0.434, 1.7, 6.5, 24.1, 92.7, 357.9, 1398.8],
        insert_merge: [0.417, 1.7, 6.4, 23.5, 90.3, 348.6, 1362.4],
    },
    Culling {
        interior: "closed",
        culling: false,
        total: [0.235, 0.695, 2.5, 9.1, 35.8, 139.5, 550.5],
        insert_merge: [0.146, 0.580, 2.3, 8.4, 33.2, 130.1, 515.2],
    },
    Culling {
        interior: "open",
        culling: true,
        total: [0.300, 1.2, 4.5, 16.3, 61.5, 235.4, 906.4],
        insert_merge: [0.283, 1.2, 4.4, 15.7, 59.2, 226.1, 870.1],
    },
    Culling {
        interior: "closed",
        culling: true,
        total: [0.113, 0.185, 0.377, 1.1, 3.3, 10.9, 38.1],
        insert_merge: [0.025, 0.072, 0.151, 0.347, 0.763, 1.6, 3.3],
    },
];

/// A scene of table 2, in millions of bytes.
pub struct Size {
    pub scene: &'static str,
    /// By the rule of 2015.
    pub new: [f64; 7],
    /// By that of 2014.
    pub old: [f64; 7],
    /// What the paper has for the latter over the former.
    pub ratio: [f64; 7],
}

pub const TABLE_2: [Size; 2] = [
    Size {
        scene: "Closed City",
        new: [0.83, 1.89, 3.96, 7.70, 14.28, 26.15, 48.04],
        old: [1.18, 2.82, 6.25, 12.87, 25.43, 49.72, 100.05],
        ratio: [1.43, 1.49, 1.58, 1.67, 1.78, 1.90, 2.08],
    },
    Size {
        scene: "Fractal Landscape",
        new: [0.44, 0.84, 1.60, 3.05, 5.76, 10.85, 20.35],
        old: [0.76, 1.59, 3.34, 6.98, 14.36, 29.30, 60.99],
        ratio: [1.72, 1.90, 2.08, 2.29, 2.49, 2.70, 3.00],
    },
];

/// Resolutions of table 3's columns.
pub const TABLE_3_RESOLUTIONS: [u32; 4] = [4096, 16_384, 65_536, 262_144];

/// Policy, stage and seconds of table 3: Closed City, with culling.
pub const TABLE_3: [(&str, &str, [f64; 4]); 15] = [
    ("open", WHOLE, [0.300, 4.5, 61.5, 906.4]),
    ("open", "enter depth map", [0.004, 0.020, 0.291, 4.5]),
    ("open", "visibility masks", [0.002, 0.029, 0.482, 7.8]),
    ("open", "min-max", [0.001, 0.001, 0.007, 0.119]),
    ("open", "transfer", [0.007, 0.090, 1.4, 22.6]),
    ("open", "insert nodes", [0.107, 1.7, 22.1, 339.8]),
    ("open", "merge nodes", [0.176, 2.7, 37.2, 530.4]),
    ("closed", WHOLE, [0.113, 0.377, 3.3, 38.1]),
    ("closed", "enter depth map", [0.005, 0.019, 0.271, 4.4]),
    ("closed", "exit depth map", [0.078, 0.176, 1.8, 23.0]),
    ("closed", "visibility masks", [0.001, 0.012, 0.181, 2.9]),
    ("closed", "min-max", [0.001, 0.001, 0.007, 0.111]),
    ("closed", "transfer", [0.002, 0.016, 0.245, 3.9]),
    ("closed", "insert nodes", [0.010, 0.063, 0.312, 1.4]),
    ("closed", "merge nodes", [0.015, 0.088, 0.451, 2.0]),
];

/// What all stages together are called.
pub const WHOLE: &str = "whole";

/// Scene, policy, method and seconds of table 4.
pub const TABLE_4: [(&str, &str, &str, [Option<f64>; 7]); 6] = [
    ("Necropolis (2015)", "open", "2015", all([0.209, 0.720, 2.6, 9.6, 34.5, 126.6, 470.4])),
    ("Closed City (2015)", "open", "2015", all([0.300, 1.2, 4.5, 16.3, 61.5, 235.4, 906.4])),
    ("Closed City (2015)", "closed", "2015", all([0.113, 0.185, 0.377, 1.1, 3.3, 10.9, 38.1])),
    ("Fractal Landscape (2015)", "open", "2015", all([0.264, 1.0, 4.0, 15.2, 57.6, 220.7, 874.2])),
    ("Fractal Landscape (2015)", "closed", "2015", all([0.056, 0.091, 0.192, 0.570, 2.0, 7.1, 25.3])),
    (
        "Sintorn et al. 2014, as cited",
        "closed",
        "2014",
        [Some(2.0), Some(18.0), None, Some(68.0), Some(256.0), Some(1055.0), Some(5520.0)],
    ),
];

const fn all(seconds: [f64; 7]) -> [Option<f64>; 7] {
    let [a, b, c, d, e, f, g] = seconds;
    [Some(a), Some(b), Some(c), Some(d), Some(e), Some(f), Some(g)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_agree_where_they_tell_the_same() {
        for (interior, table_1, table_4) in [("open", &TABLE_1[2], &TABLE_4[1]), ("closed", &TABLE_1[3], &TABLE_4[2])] {
            assert_eq!((table_1.interior, table_4.1), (interior, interior));
            assert_eq!(table_1.total.map(Some), table_4.3);
            let whole = TABLE_3.iter().find(|row| row.0 == interior && row.1 == WHOLE).expect("a row");
            assert_eq!(whole.2, [0, 2, 4, 6].map(|i| table_1.total[i]));
        }
        for table in TABLE_1 {
            assert!(table.total.iter().zip(table.insert_merge).all(|(total, part)| *total >= part));
        }
    }

    #[test]
    fn ratios_are_those_of_the_sizes() {
        for size in TABLE_2 {
            let close = |i: usize| (size.old[i] / size.new[i] / size.ratio[i] - 1.0).abs() < 0.01;
            assert!((0..7).all(close), "{}", size.scene);
        }
    }

    #[test]
    fn times_are_written_as_in_the_paper() {
        assert_eq!([0.025, 1.0, 1398.8].map(time), ["25 ms", "1.0 s", "1398.8 s"]);
    }

    #[test]
    fn stages_add_up() {
        for interior in ["open", "closed"] {
            let rows: Vec<_> = TABLE_3.iter().filter(|row| row.0 == interior).collect();
            for column in 0..4 {
                let stages: f64 = rows[1..].iter().map(|row| row.2[column]).sum();
                assert!((stages / rows[0].2[column] - 1.0).abs() < 0.03, "{interior}, {column}: {stages}");
            }
        }
    }
}
