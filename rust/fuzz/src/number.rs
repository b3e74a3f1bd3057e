//! Numbers as they come: mostly tame, some wild. Bytes that are missing count as 0, which is tame.

use arbitrary::{Result, Unstructured};

/// A few bits, of any power of ten that files hold, or anything at all.
pub fn number(input: &mut Unstructured) -> Result<f64> {
    Ok(match input.int_in_range(0..=15)? {
        15 => input.arbitrary()?,
        12..=14 => {
            let mantissa = f64::from(input.arbitrary::<i8>()?);
            mantissa * 10_f64.powi(input.int_in_range(-12..=9)?)
        }
        _ => f64::from(input.arbitrary::<i8>()?) / 16.0,
    })
}

/// Up to 8 of them.
pub fn numbers(input: &mut Unstructured) -> Result<Vec<f64>> {
    let count = input.int_in_range(0..=8)?;
    (0..count).map(|_| number(input)).collect()
}

/// Three of them.
pub fn point(input: &mut Unstructured) -> Result<[f64; 3]> {
    Ok([number(input)?, number(input)?, number(input)?])
}

/// A share in (0, 1), as tolerances are, or now and then anything.
pub fn tolerance(input: &mut Unstructured) -> Result<f64> {
    match input.int_in_range(0..=7)? {
        7 => number(input),
        power => Ok(10_f64.powi(-1 - power / 2)),
    }
}

/// Times for a flow: increasing from 0, or now and then anything.
pub fn times(input: &mut Unstructured) -> Result<Vec<f64>> {
    let mut times = numbers(input)?;
    if input.ratio(15, 16)? {
        let mut sum = 0.0;
        for time in &mut times {
            sum += time.abs();
            *time = sum;
        }
        times.insert(0, 0.0);
    }
    Ok(times)
}
