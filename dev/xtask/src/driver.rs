//! A Vulkan driver for the tests that draw: a software one is installed where there is none.

use std::path::PathBuf;
use std::process::Command;

use anyhow::{Result, bail};

/// Where drivers announce themselves on Linux.
const FOLDERS: [&str; 4] =
    ["/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d", "/usr/local/share/vulkan/icd.d", "/usr/local/etc/vulkan/icd.d"];
/// Mesa's software driver, the loader, and what the window's test needs.
const PACKAGES: [&str; 7] =
    ["mesa-vulkan-drivers", "libvulkan1", "xvfb", "libxkbcommon-x11-0", "libxcursor1", "libxi6", "libx11-xcb1"];

/// Says which driver there is, or installs one.
pub fn ensure() -> Result<()> {
    // Elsewhere the system brings Metal or Direct3D 12.
    if !cfg!(target_os = "linux") {
        return Ok(());
    }
    if let Some(driver) = announced() {
        println!("Vulkan driver: {driver}");
        return Ok(());
    }
    println!("No Vulkan driver is here; installing a software one: {}", PACKAGES.join(" "));
    let install = |words: &[&str]| {
        let sudo = !is_root();
        let mut command = Command::new(if sudo { "sudo" } else { "apt-get" });
        command
            .args(if sudo { &["-n", "apt-get"][..] } else { &[] })
            .args(words)
            .env("DEBIAN_FRONTEND", "noninteractive");
        command.status().is_ok_and(|status| status.success())
    };
    let all = [&["install", "-y", "--no-install-recommends"], &PACKAGES[..]].concat();
    if !(install(&all) || (install(&["update"]) && install(&all))) || announced().is_none() {
        bail!(
            "no Vulkan driver could be installed: install your graphics card's, or Mesa's software driver \
             (Debian: mesa-vulkan-drivers; Fedora: mesa-vulkan-drivers; Arch: vulkan-swrast), and start again"
        );
    }
    Ok(())
}

/// A driver's file, or what the environment names.
fn announced() -> Option<String> {
    let named = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"].iter().find_map(|name| std::env::var(name).ok());
    let home = std::env::var_os("HOME").map(|home| PathBuf::from(home).join(".local/share/vulkan/icd.d"));
    let folders = FOLDERS.iter().map(PathBuf::from).chain(home);
    let mut files = folders.filter_map(|folder| folder.read_dir().ok()).flatten().flatten();
    named.or_else(|| files.next().map(|file| file.path().display().to_string()))
}

fn is_root() -> bool {
    Command::new("id").arg("-u").output().is_ok_and(|output| output.stdout.starts_with(b"0"))
}
