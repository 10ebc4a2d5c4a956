use super::*;
use crate::synthesis::NoiseGenerator;

const RATE: f64 = 10.0;

fn record() -> Vec<f64> {
    let terms = CompositeTerms {
        white: 0.02,
        random_walk: 0.002,
        ..CompositeTerms::default()
    };
    let mut record = vec![0.0; 20_000];
    NoiseGenerator::new(&terms.to_shaping(1.0 / RATE).unwrap(), 1).fill(&mut record);
    record
}

#[test]
fn the_model_of_the_allan_deviation_has_its_white_noise_and_its_walk() {
    let record = record();
    let mut part = TrainingSet::new(vec![&record], RATE, 1).unwrap();
    let walk = part.allan.random_walk.value;
    assert!((walk / 0.002 - 1.0).abs() < 0.3, "{walk}");
    let whole = Recipe::AllanWalk.fit(&part, None, &[]).unwrap();
    assert_eq!(whole.model.random_walk, Some(walk));
    assert_eq!(whole.model.white, Some(part.allan.white.value));
    // A level beside them.
    assert_eq!(whole.parameters, 3);
    let alone = Recipe::White.fit(&part, None, &[]).unwrap();
    assert_eq!(
        (alone.model.white, alone.model.random_walk),
        (Some(part.allan.white.value), None)
    );
    // A half may show no walk; the whole has to.
    part.allan.random_walk.value = 0.0;
    assert!(Recipe::AllanWalk.fit(&part, None, &[]).is_none());
    let half = Recipe::AllanWalk.fit(&part, Some(&whole), &[]).unwrap();
    assert_eq!(half.model.random_walk, None);
}
