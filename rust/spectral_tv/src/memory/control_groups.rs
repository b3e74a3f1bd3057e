//! Limits of Linux's control groups: those of containers, services and cluster jobs.
//!
//! A process belongs to one group of each hierarchy. In version 1 of control groups memory has a
//! hierarchy of its own; version 2 has one for everything. The limits of all enclosing groups hold
//! too.

use std::fs;
use std::path::{Path, PathBuf};

/// The files of one version of groups.
struct Version {
    /// What the system calls a mounted hierarchy of it.
    file_system: &'static str,
    /// Bytes that may be used; any of them, and no number where there is no limit.
    limits: &'static [&'static str],
    used: &'static str,
    /// Entries of the file `memory.stat`: memory that the system reclaims before a limit counts.
    reclaimable: &'static [&'static str],
}

const FIRST: Version = Version {
    file_system: "cgroup",
    limits: &["memory.limit_in_bytes"],
    used: "memory.usage_in_bytes",
    reclaimable: &["total_inactive_file", "total_active_file"],
};
const SECOND: Version = Version {
    file_system: "cgroup2",
    limits: &["memory.max", "memory.high"],
    used: "memory.current",
    reclaimable: &["inactive_file", "active_file", "slab_reclaimable"],
};

/// Bytes that the groups of a process leave to it, by its files `cgroup` and `mountinfo`; `None`
/// where nothing limits it.
pub(super) fn left(groups: &str, mounts: &str) -> Option<u64> {
    let version = |line: &str| match line.splitn(3, ':').collect::<Vec<_>>()[..] {
        [_, "", path] => Some((&SECOND, path.to_owned())),
        [_, controllers, path] if controllers.split(',').any(|name| name == "memory") => {
            Some((&FIRST, path.to_owned()))
        }
        _ => None,
    };
    let groups = groups.lines().filter_map(version);
    groups
        .flat_map(|(version, path)| levels(version, &path, mounts))
        .filter_map(|(version, level)| left_at(version, &level))
        .min()
}

/// The folders of a group and of those around it.
fn levels(version: &'static Version, path: &str, mounts: &str) -> Vec<(&'static Version, PathBuf)> {
    let mut levels = Vec::new();
    for mount in mounts.lines().filter_map(Mount::read) {
        let is_meant = match version.file_system {
            "cgroup" => mount.options.split(',').any(|name| name == "memory"),
            _ => true,
        };
        if mount.file_system != version.file_system || !is_meant {
            continue;
        }
        // Where the group is not below what is mounted, that is at least around it.
        let below = Path::new(path).strip_prefix(&mount.root);
        let folder = below.map_or_else(|_| mount.place.clone(), |below| mount.place.join(below));
        let around = folder
            .ancestors()
            .take_while(|f| f.starts_with(&mount.place));
        levels.extend(around.map(|folder| (version, folder.to_owned())));
    }
    levels
}

/// What the limits of one group leave.
fn left_at(version: &Version, folder: &Path) -> Option<u64> {
    let read = |name: &str| fs::read_to_string(folder.join(name)).ok();
    let number = |name: &&str| read(name)?.trim().parse::<u64>().ok();
    let limit = version.limits.iter().filter_map(number).min()?;
    let statistics = read("memory.stat").unwrap_or_default();
    let values = statistics.lines().filter_map(|line| {
        let (name, value) = line.split_once(' ')?;
        let is_meant = version.reclaimable.contains(&name);
        is_meant.then(|| value.parse::<u64>().ok()).flatten()
    });
    let used = number(&version.used)?.saturating_sub(values.sum());
    Some(limit.saturating_sub(used))
}

/// A line of `mountinfo`.
struct Mount<'a> {
    /// What of the hierarchy is mounted.
    root: PathBuf,
    place: PathBuf,
    file_system: &'a str,
    options: &'a str,
}

impl<'a> Mount<'a> {
    fn read(line: &'a str) -> Option<Self> {
        let (before, after) = line.split_once(" - ")?;
        let mut before = before.split(' ').skip(3);
        let (root, place) = (before.next()?, before.next()?);
        let mut after = after.splitn(3, ' ');
        Some(Self {
            root: unescaped(root).into(),
            place: unescaped(place).into(),
            file_system: after.next()?,
            options: after.nth(1)?,
        })
    }
}

/// A path without the octal numbers that stand for blanks and the like.
fn unescaped(path: &str) -> String {
    let mut parts = path.split('\\');
    let mut plain = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let code = part.get(..3).map(|digits| u8::from_str_radix(digits, 8));
        match code {
            Some(Ok(code)) => {
                plain.push(char::from(code));
                plain.push_str(&part[3..]);
            }
            _ => {
                plain.push('\\');
                plain.push_str(part);
            }
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder of its own, removed in the end.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let name = format!("spectral tv {name} {}", std::process::id());
            Self(std::env::temp_dir().join(name))
        }

        fn write(&self, group: &str, files: &[(&str, &str)]) {
            let group = self.0.join(group);
            fs::create_dir_all(&group).unwrap();
            for (name, text) in files {
                fs::write(group.join(name), text).unwrap();
            }
        }

        fn mount(&self, root: &str, file_system: &str, options: &str) -> String {
            let place = self.0.display().to_string().replace(' ', "\\040");
            format!(
                "22 1 0:21 / /proc rw shared:1 - proc proc rw\n\
                 30 23 0:25 {root} {place} rw,nosuid shared:9 - {file_system} cgroup {options}\n"
            )
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn the_tightest_group_of_the_second_version_counts_without_its_caches() {
        let folder = Folder::new("second");
        folder.write("", &[("memory.stat", "inactive_file 1\n")]);
        let outer = [("memory.max", "900\n"), ("memory.current", "500\n")];
        folder.write("pod", &outer);
        folder.write(
            "pod/container",
            &[
                ("memory.max", "max\n"),
                ("memory.high", "700\n"),
                ("memory.current", "400\n"),
                (
                    "memory.stat",
                    "anon 300\nactive_file 60\ninactive_file 30\nslab_reclaimable 10\n",
                ),
            ],
        );
        let mounts = folder.mount("/", "cgroup2", "rw");
        assert_eq!(left("0::/pod/container\n", &mounts), Some(400));
        folder.write("pod", &[("memory.stat", "active_file 50\n")]);
        assert_eq!(left("0::/pod/container\n", &mounts), Some(400));
        folder.write("pod", &[("memory.current", "600\n")]);
        assert_eq!(left("0::/pod/container\n", &mounts), Some(350));
        assert_eq!(left("0::/\n", &mounts), None);
        // More in use than is allowed.
        folder.write("pod", &[("memory.current", "2000\n")]);
        assert_eq!(left("0::/pod\n", &mounts), Some(0));
        // As a container sees it that has but its own group mounted.
        let mounts = folder.mount("/pod", "cgroup2", "rw");
        folder.write("", &[("memory.max", "50"), ("memory.current", "20")]);
        for seen in ["0::/pod\n", "0::/\n", "0::/../other\n"] {
            assert_eq!(left(seen, &mounts), Some(31));
        }
    }

    #[test]
    fn so_does_that_of_the_first_version() {
        let folder = Folder::new("first");
        let unlimited = "9223372036854771712\n";
        let files = |limit, used| {
            [
                ("memory.limit_in_bytes", limit),
                ("memory.usage_in_bytes", used),
            ]
        };
        folder.write("", &files(unlimited, "5000\n"));
        folder.write("docker", &files("1000\n", "700\n"));
        folder.write("docker/1f", &files("600\n", "200\n"));
        let statistics = "cache 90\ninactive_file 1\ntotal_inactive_file 40\ntotal_active_file 5\n";
        folder.write("docker/1f", &[("memory.stat", statistics)]);
        let groups = "9:name=systemd:/docker/1f\n4:cpu,memory:/docker/1f\n0::/docker/1f\n";
        let mounts = folder.mount("/", "cgroup", "rw,memory");
        assert_eq!(left(groups, &mounts), Some(300));
        folder.write("docker", &files("1000\n", "500\n"));
        assert_eq!(left(groups, &mounts), Some(445));
        // Another controller's hierarchy says nothing.
        let mounts = folder.mount("/", "cgroup", "rw,cpu");
        assert_eq!(left(groups, &mounts), None);
    }

    #[test]
    fn lines_that_say_nothing_are_passed_over() {
        assert_eq!(left("", ""), None);
        assert_eq!(
            left("0::/\nrubbish\n4:memory:/x\n", "rubbish\n1 2 3 - cgroup2\n"),
            None
        );
        assert_eq!(unescaped("/a\\040b\\134c\\9\\"), "/a b\\c\\9\\");
    }
}
