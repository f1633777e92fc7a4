//! What can go wrong with a scene file, who is at fault and what to do about it.

use std::io;
use std::path::PathBuf;

use crate::model::Dropped;

/// Why a scene could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The operating system would not hand over a file.
    #[error("cannot read {}: {source}", .path.display())]
    Read {
        /// The file in question: the scene or one that it refers to.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The file's name does not say that it is a scene.
    #[error("{}: unknown kind of scene file; supported are .glb, .gltf and .obj", .path.display())]
    UnknownFileType {
        /// The file as given.
        path: PathBuf,
    },
    /// The bytes break the rules of their format.
    #[error("{file}: {problem} (the file is damaged or invalid: fetch or export it again)")]
    Format {
        /// The scene's file.
        file: String,
        /// What is wrong, and where in the file.
        problem: String,
    },
    /// The file cannot be understood without a glTF extension that is not supported.
    #[error("{file}: requires the glTF extension {extension}, which is not supported; {advice}")]
    UnsupportedExtension {
        /// The scene's file.
        file: String,
        /// The extension's name.
        extension: String,
        /// What to do instead.
        advice: &'static str,
    },
    /// The file asks for more than a scene may have.
    #[error("{file}: {problem}; split or simplify the scene")]
    Limit {
        /// The scene's file.
        file: String,
        /// What is too large, and the limit.
        problem: String,
    },
    /// A file that is an image alone is none that can be read.
    #[error("{file} {problem}: give another picture")]
    Picture {
        /// The file's name.
        file: String,
        /// What is wrong with it.
        problem: String,
    },
    /// No placed mesh has a triangle.
    #[error("{file}: no triangle is left to work with{}", describe(.dropped))]
    NothingLeft {
        /// The scene's file or name.
        file: String,
        /// Triangles that were there but unusable.
        dropped: Dropped,
    },
    /// The model in memory cannot be put into a file.
    #[error("cannot write the scene {scene}: {problem}")]
    Unwritable {
        /// [`crate::Scene::name`].
        scene: String,
        /// What is in the way.
        problem: String,
    },
}

impl SceneError {
    /// A format error whose file is filled in further up by [`SceneError::in_file`].
    pub(crate) fn format(problem: impl Into<String>) -> Self {
        Self::Format { file: String::new(), problem: problem.into() }
    }

    /// A limit error whose file is filled in further up by [`SceneError::in_file`].
    pub(crate) fn limit(problem: impl Into<String>) -> Self {
        Self::Limit { file: String::new(), problem: problem.into() }
    }

    /// Says which file an error is about. The code that finds a fault knows the place inside the file only.
    pub(crate) fn in_file(mut self, name: &str) -> Self {
        match &mut self {
            Self::Format { file, .. }
            | Self::Limit { file, .. }
            | Self::UnsupportedExtension { file, .. }
            | Self::NothingLeft { file, .. } => name.clone_into(file),
            Self::Read { .. } | Self::UnknownFileType { .. } | Self::Picture { .. } | Self::Unwritable { .. } => {}
        }
        self
    }
}

fn describe(dropped: &Dropped) -> String {
    let Dropped { not_finite, zero_area, bad_index } = dropped;
    match dropped.total() {
        0 => ": it places no triangles; check that the right objects were exported".to_owned(),
        total => format!(
            ": all {total} were unusable ({not_finite} with corners that are not finite, {zero_area} without area, \
             {bad_index} with bad indices); repair the mesh or export it again"
        ),
    }
}
