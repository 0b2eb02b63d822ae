use forust_ml::gradientbooster::GrowPolicy;
use forust_ml::objective::ObjectiveType;
use forust_ml::{GradientBooster, Matrix};
use serde::{Deserialize, Serialize};

use crate::Error;

/// Gradient boosted regression trees (J. H. Friedman, Annals of Statistics 29, 2001), grown leaf by leaf on histograms.
///
/// Fitted by a library, kept in a form of our own: a file with trees that lead nowhere is refused.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "RawTrees")]
pub(super) struct BoostedTrees {
    base: f64,
    predictors: usize,
    trees: Vec<Vec<Node>>,
}

/// A leaf holds this many samples, and this share of all of them.
const LEAST_LEAF: f64 = 40.0;
const MOST_LEAVES: f64 = 400.0;

/// As a file has them.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawTrees {
    base: f64,
    predictors: usize,
    trees: Vec<Vec<Node>>,
}

/// A leaf, or a question with children further on in the list.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
enum Node {
    /// Predictor, threshold, the child below the threshold and the other.
    Split(usize, f64, usize, usize),
    Leaf(f64),
}

impl TryFrom<RawTrees> for BoostedTrees {
    type Error = Error;

    fn try_from(raw: RawTrees) -> Result<Self, Error> {
        let trees = Self {
            base: raw.base,
            predictors: raw.predictors,
            trees: raw.trees,
        };
        let sound = |tree: &Vec<Node>| {
            let leads_on = |(i, node): (usize, &Node)| match *node {
                Node::Leaf(value) => value.is_finite(),
                Node::Split(predictor, threshold, below, above) => {
                    let forward = |child| child > i && child < tree.len();
                    predictor < trees.predictors
                        && threshold.is_finite()
                        && forward(below)
                        && forward(above)
                }
            };
            !tree.is_empty() && tree.iter().enumerate().all(leads_on)
        };
        if trees.base.is_finite() && trees.trees.iter().all(sound) {
            return Ok(trees);
        }
        Err(Error::ModelFile {
            reason: "a tree leads nowhere; fit the model again".to_owned(),
        })
    }
}

impl BoostedTrees {
    /// Fits rows of `predictors` values each.
    ///
    /// # Errors
    /// [`Error::Fit`] where the library gives up.
    pub(super) fn fit(
        rows: &[f64],
        predictors: usize,
        response: &[f64],
        trees: usize,
    ) -> Result<Self, Error> {
        let leaf = (response.len() as f64 / MOST_LEAVES).max(LEAST_LEAF);
        let mut booster = GradientBooster::default()
            .set_objective_type(ObjectiveType::SquaredLoss)
            .set_iterations(trees)
            .set_learning_rate(0.05)
            .set_max_leaves(15)
            .set_max_depth(12)
            .set_min_leaf_weight(leaf as f32)
            .set_l2(10.0)
            .set_initialize_base_score(true)
            .set_parallel(false);
        booster.grow_policy = GrowPolicy::LossGuide;
        let columns: Vec<f64> = (0..predictors)
            .flat_map(|j| rows.iter().skip(j).step_by(predictors))
            .copied()
            .collect();
        let matrix = Matrix::new(&columns, response.len(), predictors);
        booster
            .fit_unweighted(&matrix, response, None)
            .map_err(|error| Error::Fit {
                model: "boosted-trees",
                reason: error.to_string(),
            })?;
        let trees = booster.trees.iter().map(|tree| {
            // Level by level, so that children come after their parents.
            let mut order = vec![0];
            let mut nodes = Vec::with_capacity(tree.nodes.len());
            while let Some(node) = order.get(nodes.len()).map(|&at| &tree.nodes[at]) {
                nodes.push(if node.is_leaf {
                    Node::Leaf(f64::from(node.weight_value))
                } else {
                    let below = order.len();
                    order.extend([node.left_child, node.right_child]);
                    Node::Split(node.split_feature, node.split_value, below, below + 1)
                });
            }
            nodes
        });
        Ok(Self {
            base: booster.base_score,
            predictors,
            trees: trees.collect(),
        })
    }

    /// Number of predictors.
    pub(super) fn predictors(&self) -> usize {
        self.predictors
    }

    pub(super) fn predict(&self, rows: &[f64]) -> Vec<f64> {
        let rows = rows.chunks_exact(self.predictors);
        rows.map(|row| self.answer(row)).collect()
    }

    /// For one row of predictors.
    pub(super) fn answer(&self, row: &[f64]) -> f64 {
        self.trees
            .iter()
            .fold(self.base, |sum, tree| sum + leaf(tree, row))
    }
}

fn leaf(tree: &[Node], row: &[f64]) -> f64 {
    let mut at = 0;
    loop {
        match tree[at] {
            Node::Leaf(value) => return value,
            Node::Split(predictor, threshold, below, above) => {
                at = if row[predictor] < threshold {
                    below
                } else {
                    above
                };
            }
        }
    }
}
