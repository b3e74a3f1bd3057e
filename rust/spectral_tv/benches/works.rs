//! Small fixed works whose instructions are counted, one a process: `works NAME`.
//!
//! Without a name it lists them. All runs on the calling thread, so that counts are the same
//! every time; `tools/bench/instructions.py` counts and compares.

use std::f64::consts::TAU;
use std::hint::black_box;
use std::process::ExitCode;

use ndarray::{Array1, Array2};

use spectral_tv::Result;
use spectral_tv::deformation::{self, Algorithm, Constraints, Deformer};
use spectral_tv::discretization::Discretization;
use spectral_tv::flow::{Scheme, Stepping, TotalVariation, Trajectory};
use spectral_tv::mesh::TriangleMesh;
use spectral_tv::method::{Settings, decompose, graded_times};
use spectral_tv::solver::Solver;
use spectral_tv::spectral::SpectralTransform;

/// Vertices around the tube of the torus; twice as many along it: 10 368 in all.
const AROUND: usize = 72;
/// Few steps: Valgrind takes a factorization's fused multiplications one by one.
const STEPS: usize = 5;

/// A name, and the work that it stands for.
type Work = (&'static str, fn(&TriangleMesh) -> Result<()>);

const WORKS: [Work; 12] = [
    ("mesh", |mesh| {
        black_box(Discretization::new(mesh)?);
        Ok(())
    }),
    ("m1 cholesky", |mesh| {
        flow(mesh, Settings::m1(), Solver::Cholesky)
    }),
    ("m1 multigrid", |mesh| {
        flow(mesh, Settings::m1(), Solver::Multigrid)
    }),
    ("m2 cholesky", |mesh| {
        flow(mesh, Settings::m2(), Solver::Cholesky)
    }),
    ("m2 multigrid", |mesh| {
        flow(mesh, Settings::m2(), Solver::Multigrid)
    }),
    ("m3 cholesky", |mesh| {
        flow(mesh, Settings::m3(), Solver::Cholesky)
    }),
    ("m3 multigrid", |mesh| {
        flow(mesh, Settings::m3(), Solver::Multigrid)
    }),
    ("exact function", exact_function),
    ("exact shape", exact_shape),
    ("deform", deform),
    ("drag", drag),
    ("spectrum and filter", spectrum_and_filter),
];

fn main() -> ExitCode {
    // Cargo adds --bench.
    let name = std::env::args().skip(1).find(|name| name != "--bench");
    let Some(name) = name else {
        WORKS.iter().for_each(|(name, _)| println!("{name}"));
        return ExitCode::SUCCESS;
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .use_current_thread();
    let work = WORKS.iter().find(|(known, _)| *known == name);
    let outcome = match (work, pool.build_global()) {
        (None, _) => Err(format!("there is no work named {name:?}")),
        (_, Err(error)) => Err(error.to_string()),
        (Some((_, work)), Ok(())) => torus()
            .and_then(|mesh| work(&mesh))
            .map_err(|error| error.to_string()),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

/// A torus with bumps of several sizes.
fn torus() -> Result<TriangleMesh> {
    let along = 2 * AROUND;
    let point = |i: usize, j: usize| {
        let u = TAU * i as f64 / along as f64;
        let v = TAU * j as f64 / AROUND as f64;
        let wave = |k: f64| (k * u).sin() * ((0.5 * k).ceil() * v).cos() / k;
        let radius = 0.5 + 0.1 * [5.0, 11.0, 23.0].map(wave).iter().sum::<f64>();
        let distance = 1.2 + radius * v.cos();
        [distance * u.cos(), distance * u.sin(), radius * v.sin()]
    };
    let index = |i: usize, j: usize| ((i % along) * AROUND + j % AROUND) as i64;
    let cells = || (0..along).flat_map(|i| (0..AROUND).map(move |j| (i, j)));
    let vertices = cells().map(|(i, j)| point(i, j)).collect();
    let triangles: Vec<[i64; 3]> = cells()
        .flat_map(|(i, j)| {
            let (a, b) = (index(i, j), index(i + 1, j));
            let (c, d) = (index(i + 1, j + 1), index(i, j + 1));
            [[a, b, c], [a, c, d]]
        })
        .collect();
    TriangleMesh::new(vertices, &triangles)
}

fn flow(mesh: &TriangleMesh, mut settings: Settings, solver: Solver) -> Result<()> {
    settings.steps = STEPS;
    settings.stepping.solver = solver;
    black_box(decompose(mesh, &settings)?);
    Ok(())
}

/// The indicator of an upper part, to a gap of 1e-3.
fn exact_function(mesh: &TriangleMesh) -> Result<()> {
    let upper = |vertex: usize| f64::from(u8::from(mesh.vertices()[vertex][2] > 0.2));
    let values = Array2::from_shape_fn((1, mesh.vertex_count()), |(_, vertex)| upper(vertex));
    exact(mesh, values, &[0.0, 0.05])
}

fn exact_shape(mesh: &TriangleMesh) -> Result<()> {
    let times = graded_times(1e-5 * mesh.area(), 1e-3 * mesh.area(), 1)?;
    let shape = spectral_tv::operators::positions(mesh);
    exact(mesh, shape, &times)
}

fn exact(mesh: &TriangleMesh, values: Array2<f64>, times: &[f64]) -> Result<()> {
    let operators = Discretization::new(mesh)?;
    let law = TotalVariation::default().starting_at(&operators, values.view())?;
    let stepping = Stepping {
        scheme: Scheme::Exact,
        ..Stepping::default()
    };
    black_box(stepping.run(&operators, &law, values, times)?);
    Ok(())
}

/// One end of the torus held, the other moved by `way`: the vertices and where they go.
fn pull(mesh: &TriangleMesh, way: f64) -> (Vec<i64>, Vec<[f64; 3]>) {
    let ends = mesh.vertices().iter().enumerate();
    ends.filter(|(_, [x, _, _])| x.abs() > 1.4)
        .map(|(vertex, &[x, y, z])| match x > 0.0 {
            true => (vertex as i64, [x + way, y + 0.3 * way, z + 0.5 * way]),
            false => (vertex as i64, [x, y, z]),
        })
        .unzip()
}

fn deform(mesh: &TriangleMesh) -> Result<()> {
    let (indices, targets) = pull(mesh, 0.5);
    let settings = deformation::Settings {
        algorithm: Algorithm::Convex,
        softness: 0.0,
        tolerance: 1e-2,
    };
    let constraints = Constraints::new(mesh, &indices, None)?;
    black_box(deformation::deform(mesh, constraints, &targets, settings)?);
    Ok(())
}

/// Frames of a drag from rest.
fn drag(mesh: &TriangleMesh) -> Result<()> {
    let constraints = Constraints::new(mesh, &pull(mesh, 0.0).0, None)?;
    let mut deformer = Deformer::new(mesh, constraints, 0.0)?;
    for frame in 1..=3 {
        black_box(deformer.drag(&pull(mesh, 0.05 * f64::from(frame)).1)?);
    }
    Ok(())
}

/// What is done with a flow: its spectrum, a filter, and bands cut twice.
fn spectrum_and_filter(mesh: &TriangleMesh) -> Result<()> {
    let times = Settings::m1().default_times(mesh.area(), 32)?;
    let shape = spectral_tv::operators::positions(mesh);
    let operators = Discretization::new(mesh)?;
    let decay = |k: usize, _: &Array1<f64>| {
        Array2::from_shape_fn(shape.dim(), |(channel, vertex)| {
            let extinction = 1 + (vertex % times.len());
            shape[[channel, vertex]] * (1.0 - k as f64 / extinction as f64).max(0.0)
        })
    };
    let initial = shape.clone();
    let flow = Trajectory::sampled(&operators, &times, initial, decay)?;
    let transform = SpectralTransform::new(flow);
    black_box(transform.spectrum(mesh.vertex_areas()));
    let gains: Vec<f64> = (1..32).map(|k| f64::from(k) / 31.0).collect();
    black_box(transform.filter(&gains)?);
    for count in [5, 8] {
        let edges = spectral_tv::spectral::even_edges(transform.times(), count)?;
        transform
            .bands(&edges)?
            .for_each(|band| drop(black_box(band)));
    }
    Ok(())
}
