//! The lumped masses of the vertices.

/// Vertex areas, with the mean in place of 0: a vertex in no triangle has no neighbours either,
/// so any mass keeps it where it is and M invertible.
pub fn invertible_masses(vertex_areas: &[f64]) -> Vec<f64> {
    let mean = vertex_areas.iter().sum::<f64>() / vertex_areas.len() as f64;
    vertex_areas
        .iter()
        .map(|&area| if area > 0.0 { area } else { mean })
        .collect()
}
