//! Fibres as start files have them: whole, or with one solution of each orbit under the stated symmetry.

use super::compiled::Family;
use super::error::FamilyError;
use super::fibre::Fibre;
use super::start_file::StartFile;
use super::still::refined;
use crate::distinct::relative_distance;
use crate::refine::Refiner;
use crate::tolerances::{families, same};
use num_complex::Complex64;

impl Family {
    /// The fibre of a start file, with the solutions that listed ones [stand for](StartFile::represents). If the family
    /// has symmetries, one solution of each orbit is marked as representative.
    ///
    /// ```
    /// use hc::{Family, MonodromyOptions};
    ///
    /// let family: Family = "name = ''\nunknowns = ['x', 'y']\nparameters = ['a', 'b']\nequations = ['x^2 + y^2 - a', 'x*y - b']\n\
    ///                       symmetry = [['-x', '-y'], ['y', 'x']]".parse()?;
    /// let file = family.monodromy(&MonodromyOptions::new())?.start_file();
    /// let listed = family.up_to_symmetry(&file)?;
    /// assert_eq!((file.solutions.len(), listed.solutions.len()), (4, 1));
    /// assert_eq!(family.stored(&listed)?.len(), 4);
    /// # Ok::<(), hc::FamilyError>(())
    /// ```
    ///
    /// # Errors
    /// If a number is not finite, solutions differ in length or are those of another family, or a listed solution does
    /// not stand for as many as the file says.
    pub fn stored(&self, file: &StartFile) -> Result<Fibre, FamilyError> {
        let listed = file.listed()?;
        self.check(&listed)?;
        if file.represents.is_empty() {
            return Ok(self.folded(listed));
        }
        let mut refiner = Refiner::new(&self.program);
        let (mut solutions, mut representatives) = (Vec::new(), Vec::new());
        for (k, (x, &stated)) in listed.iter().zip(&file.represents).enumerate() {
            let orbit = self.symmetry.orbit(&listed.parameters, x, same::REGULAR);
            if orbit.len() != stated {
                return Err(FamilyError::Represents { solution: k + 1, stated, found: orbit.len() });
            }
            representatives.push(solutions.len() / listed.dimension.max(1));
            solutions.extend_from_slice(x);
            for image in orbit.into_iter().skip(1) {
                let refined = refined(&mut refiner, &listed.parameters, &image);
                let is_near =
                    refined.accuracy < families::ACCURATE && relative_distance(&refined.point, &image) <= same::REGULAR;
                solutions.extend(if is_near { refined.point } else { image });
            }
        }
        Ok(Fibre { solutions, representatives: Some(representatives), ..listed })
    }

    /// A start file with the first solution of each orbit under the family's symmetry, and how many solutions each
    /// [stands for](StartFile::represents). It has no monodromy group, whose permutations are those of all solutions.
    ///
    /// # Errors
    /// Those of [`stored`](Self::stored); also if the family states no symmetry, or one that is none.
    pub fn up_to_symmetry(&self, file: &StartFile) -> Result<StartFile, FamilyError> {
        if self.symmetry.is_trivial() {
            return Err(FamilyError::NoSymmetry);
        }
        let fibre = self.stored(file)?;
        self.check_symmetry(&fibre)?;
        let points: Vec<&[Complex64]> = fibre.iter().collect();
        let orbits = self.symmetry.orbits(&fibre.parameters, &points, |_| same::REGULAR);
        let pairs = |orbit: &Vec<usize>| points[orbit[0]].iter().map(|z| [z.re, z.im]).collect();
        Ok(StartFile {
            solutions: orbits.iter().map(pairs).collect(),
            represents: orbits.iter().map(Vec::len).collect(),
            monodromy_group: None,
            ..file.clone()
        })
    }

    /// The fibre with one solution of each orbit marked as representative, if the family has
    /// symmetries. Only the representatives are then tracked.
    #[must_use]
    pub fn folded(&self, fibre: Fibre) -> Fibre {
        if self.symmetry.is_trivial() || fibre.representatives.is_some() {
            return fibre;
        }
        let points: Vec<&[Complex64]> = fibre.iter().collect();
        let orbits = self.symmetry.orbits(&fibre.parameters, &points, |_| same::REGULAR);
        let representatives = Some(orbits.iter().map(|orbit| orbit[0]).collect());
        Fibre { representatives, ..fibre }
    }
}

#[cfg(test)]
mod tests {
    use crate::MonodromyOptions;
    use crate::family::{Family, FamilyError, StartFile};

    fn family(symmetry: &str) -> Family {
        let text = "name = ''\nunknowns = ['x', 'y']\nparameters = ['a', 'b', 'c']\n\
                    equations = ['x^4 + a*x^2 + b', 'y^2 - c']\n";
        format!("{text}symmetry = {symmetry}").parse().unwrap()
    }

    /// Eight solutions: two orbits of `x, -x` and `y, -y`, four of `-x` alone.
    #[test]
    fn orbits_are_listed_once_and_read_back_whole() {
        for (symmetry, size) in [("[['-x', 'y'], ['x', '-y']]", 4), ("[['-x', 'y']]", 2)] {
            let family = family(symmetry);
            let found = family.monodromy(&MonodromyOptions::new()).unwrap();
            let file = found.start_file();
            let listed = family.up_to_symmetry(&file).unwrap();
            assert_eq!(listed.represents, vec![size; 8 / size]);
            let read = family.stored(&StartFile::from_json(&listed.to_json()).unwrap()).unwrap();
            assert_eq!((read.len(), read.is_partial), (8, false));
            let known = crate::distinct::Known::new(found.fibre.iter());
            assert!(read.iter().all(|x| known.has(x, 1e-12)));
            assert_eq!(read.representatives.as_ref().map(Vec::len), Some(8 / size));
            // Twice is once.
            assert_eq!(family.up_to_symmetry(&listed).unwrap(), listed);
        }
    }

    #[test]
    fn what_does_not_stand_for_so_many_is_named() {
        let both = family("[['-x', 'y'], ['x', '-y']]");
        let file = both.monodromy(&MonodromyOptions::new()).unwrap().start_file();
        let listed = both.up_to_symmetry(&file).unwrap();
        let other = family("[['-x', 'y']]");
        assert_eq!(other.stored(&listed), Err(FamilyError::Represents { solution: 1, stated: 4, found: 2 }));
        let none = family("[]");
        assert_eq!(none.up_to_symmetry(&file), Err(FamilyError::NoSymmetry));
        assert!(matches!(none.stored(&listed), Err(FamilyError::Represents { found: 1, .. })));
        let short = StartFile { represents: vec![4], ..listed };
        assert!(matches!(both.stored(&short), Err(FamilyError::Start(_))));
    }
}
