//! The connected components of a mesh.

use petgraph::unionfind::UnionFind;

/// The number of every vertex's connected component, in the order of their first vertices, where
/// `triangles` of these `areas` connect them. A triangle without area connects nothing; a vertex in
/// no other is a component of its own.
pub(crate) fn components_of(
    vertex_count: usize,
    triangles: &[[u32; 3]],
    areas: &[f64],
) -> Vec<u32> {
    let mut components = UnionFind::new(vertex_count);
    for (&[i, j, k], &area) in triangles.iter().zip(areas) {
        if area > 0.0 {
            components.union(i, j);
            components.union(j, k);
        }
    }
    let mut labels = components.into_labeling();
    let mut numbers = vec![u32::MAX; vertex_count];
    let mut count = 0;
    for label in &mut labels {
        let number = &mut numbers[*label as usize];
        if *number == u32::MAX {
            *number = count;
            count += 1;
        }
        *label = *number;
    }
    labels
}

/// How many components these are.
pub(crate) fn component_count(components: &[u32]) -> usize {
    components.iter().max().map_or(0, |&last| last as usize + 1)
}

/// How many components have a triangle with area.
pub(super) fn surface_count(components: &[u32], triangles: &[[u32; 3]], areas: &[f64]) -> usize {
    let mut has_area = vec![false; component_count(components)];
    for (triangle, &area) in triangles.iter().zip(areas) {
        has_area[components[triangle[0] as usize] as usize] |= area > 0.0;
    }
    has_area.iter().filter(|&&has_area| has_area).count()
}
