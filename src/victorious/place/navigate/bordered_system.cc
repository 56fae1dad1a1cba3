#include "victorious/place/navigate/bordered_system.h"

#include <utility>

#include <Eigen/Cholesky>

namespace victorious {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Factors of the chain: L diag(P) L', where P are the pivots and E the blocks below the diagonal of L.
struct BorderedSystem::Factors {
  std::vector<Eigen::LLT<MatrixXd>> pivots;
  std::vector<MatrixXd> below;   // E_k = U_k' inverse(P_k)
  std::vector<MatrixXd> solved;  // inverse(chain) * border, by block
  // Schur complement of the chain: C - B' inverse(chain) B; std::nullopt without a border.
  std::optional<Eigen::LLT<MatrixXd>> remainder;

  // inverse(chain) * sides, in place.
  void SolveChain(std::vector<MatrixXd>& sides) const {
    if (sides.empty() || sides.front().size() == 0) return;  // no border
    for (std::size_t k = 1; k < sides.size(); ++k) sides[k] -= below[k - 1] * sides[k - 1];
    for (std::size_t k = sides.size(); k-- > 0;) {
      sides[k] = pivots[k].solve(sides[k]).eval();
      if (k + 1 < sides.size()) sides[k] -= below[k].transpose() * sides[k + 1];
    }
  }
};

BorderedSystem::BorderedSystem(std::size_t blocks, Index block_size, Index border_size)
    : diagonal(blocks, MatrixXd::Zero(block_size, block_size)),
      upper(blocks > 0 ? blocks - 1 : 0, MatrixXd::Zero(block_size, block_size)),
      border(blocks),
      rhs(blocks, VectorXd::Zero(block_size)),
      corner(MatrixXd::Zero(border_size, border_size)),
      corner_rhs(VectorXd::Zero(border_size)),
      block_size_(block_size) {}

std::optional<BorderedSystem::Factors> BorderedSystem::Factorise(double damping) const {
  Factors factors;
  for (std::size_t k = 0; k < blocks(); ++k) {
    MatrixXd pivot = diagonal[k];
    pivot.diagonal() *= 1 + damping;
    if (k > 0) {
      factors.below.push_back(factors.pivots.back().solve(upper[k - 1]).transpose());
      pivot -= factors.below.back() * upper[k - 1];
    }
    factors.pivots.emplace_back(pivot);
    if (factors.pivots.back().info() != Eigen::Success) return std::nullopt;
  }
  factors.solved.assign(blocks(), MatrixXd::Zero(block_size_, border_size()));
  for (std::size_t k = 0; k < blocks(); ++k) {
    for (const Part& part : border[k]) factors.solved[k].middleCols(part.first, part.columns.cols()) += part.columns;
  }
  factors.SolveChain(factors.solved);
  MatrixXd remainder = corner;
  remainder.diagonal() *= 1 + damping;
  for (std::size_t k = 0; k < blocks(); ++k) {
    for (const Part& part : border[k]) {
      remainder.middleRows(part.first, part.columns.cols()) -= part.columns.transpose() * factors.solved[k];
    }
  }
  if (remainder.size() > 0) {
    factors.remainder.emplace(remainder);
    if (factors.remainder->info() != Eigen::Success) return std::nullopt;
  }
  return factors;
}

std::optional<BorderedSystem::Solution> BorderedSystem::Solve(double damping) const {
  const std::optional<Factors> factors = Factorise(damping);
  if (!factors) return std::nullopt;
  std::vector<MatrixXd> sides(rhs.begin(), rhs.end());
  factors->SolveChain(sides);
  VectorXd left = corner_rhs;
  for (std::size_t k = 0; k < blocks(); ++k) {
    for (const Part& part : border[k]) {
      left.segment(part.first, part.columns.cols()) -= part.columns.transpose() * sides[k];
    }
  }
  Solution solution;
  solution.border = factors->remainder ? VectorXd(factors->remainder->solve(left)) : left;
  for (std::size_t k = 0; k < blocks(); ++k) {
    solution.blocks.emplace_back(sides[k] - factors->solved[k] * solution.border);
  }
  return solution;
}

std::optional<BorderedSystem::Covariances> BorderedSystem::Invert() const {
  std::optional<Factors> factors = Factorise(/*damping=*/0);
  if (!factors) return std::nullopt;
  Covariances inverse;
  inverse.border = MatrixXd::Identity(border_size(), border_size());
  if (factors->remainder) factors->remainder->solveInPlace(inverse.border);
  inverse.blocks.resize(blocks());
  const MatrixXd identity = MatrixXd::Identity(block_size_, block_size_);
  for (std::size_t k = blocks(); k-- > 0;) {  // of the chain without the border
    inverse.blocks[k] = factors->pivots[k].solve(identity);
    if (k + 1 < blocks()) {
      inverse.blocks[k] += factors->below[k].transpose() * inverse.blocks[k + 1] * factors->below[k];
    }
  }
  for (std::size_t k = 0; k < blocks(); ++k) {
    MatrixXd cross = -factors->solved[k] * inverse.border;
    inverse.blocks[k] -= cross * factors->solved[k].transpose();
    factors->solved[k] = std::move(cross);  // reuses the memory of the largest matrices
  }
  inverse.cross = std::move(factors->solved);
  return inverse;
}

}  // namespace victorious
