#include "victorious/place/navigate/bordered_system.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "victorious/base/random.h"

namespace victorious {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd RandomMatrix(Random& random, Index rows, Index columns) {
  MatrixXd matrix(rows, columns);
  for (double& value : matrix.reshaped()) value = random.Normal();
  return matrix;
}

BorderedSystem RandomSystem(std::size_t blocks, Index size, Index border) {
  Random random(17 + blocks);
  BorderedSystem system(blocks, size, border);
  for (std::size_t k = 0; k < blocks; ++k) {
    const MatrixXd j =
        RandomMatrix(random, 3 * size, 2 * size + border);  // couples block k, the next block and the border
    const bool last = k + 1 == blocks;
    const MatrixXd normal = j.transpose() * j;
    system.diagonal[k] += normal.topLeftCorner(size, size);
    // The first column as a separate part, as if of two landmarks.
    const Index first = std::min<Index>(border, 1);
    system.border[k].push_back({0, normal.block(0, 2 * size, size, first)});
    system.border[k].push_back({first, normal.topRightCorner(size, border - first)});
    system.corner += normal.bottomRightCorner(border, border);
    if (!last) {
      system.diagonal[k + 1] += normal.block(size, size, size, size);
      system.upper[k] += normal.block(0, size, size, size);
      system.border[k + 1].push_back({0, normal.block(size, 2 * size, size, border)});
    }
    system.rhs[k] = RandomMatrix(random, size, 1);
  }
  system.corner_rhs = RandomMatrix(random, border, 1);
  return system;
}

MatrixXd Dense(const BorderedSystem& system) {
  const Index size = system.block_size();
  const Index chain = size * static_cast<Index>(system.blocks());
  MatrixXd dense = MatrixXd::Zero(chain + system.border_size(), chain + system.border_size());
  for (std::size_t k = 0; k < system.blocks(); ++k) {
    const Index at = size * static_cast<Index>(k);
    dense.block(at, at, size, size) = system.diagonal[k];
    for (const BorderedSystem::Part& part : system.border[k]) {
      dense.block(at, chain + part.first, size, part.columns.cols()) += part.columns;
    }
    if (k + 1 < system.blocks()) dense.block(at, at + size, size, size) = system.upper[k];
  }
  dense.bottomRightCorner(system.border_size(), system.border_size()) = system.corner;
  dense.triangularView<Eigen::StrictlyLower>() = dense.transpose();
  return dense;
}

class BorderedSystemTest : public ::testing::TestWithParam<std::pair<int, int>> {};

TEST_P(BorderedSystemTest, MatchesTheDenseSolution) {
  const auto [blocks, border] = GetParam();
  const BorderedSystem system = RandomSystem(static_cast<std::size_t>(blocks), 4, border);
  const MatrixXd inverse = Dense(system).inverse();
  VectorXd rhs(inverse.rows());
  for (int k = 0; k < blocks; ++k) rhs.segment(4 * k, 4) = system.rhs[static_cast<std::size_t>(k)];
  rhs.tail(border) = system.corner_rhs;
  const VectorXd expected = inverse * rhs;

  const auto solution = system.Solve();
  const auto covariances = system.Invert();
  ASSERT_TRUE(solution && covariances);
  for (int k = 0; k < blocks; ++k) {
    const auto at = static_cast<std::size_t>(k);
    EXPECT_TRUE(solution->blocks[at].isApprox(expected.segment(4 * k, 4), 1e-8)) << k;
    EXPECT_TRUE(covariances->blocks[at].isApprox(inverse.block(4 * k, 4 * k, 4, 4), 1e-8)) << k;
    if (border == 0) continue;
    EXPECT_TRUE(covariances->cross[at].isApprox(inverse.block(4 * k, 4 * blocks, 4, border), 1e-8)) << k;
  }
  if (border > 0) {
    EXPECT_TRUE(solution->border.isApprox(expected.tail(border), 1e-8));
    EXPECT_TRUE(covariances->border.isApprox(inverse.bottomRightCorner(border, border), 1e-8));
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, BorderedSystemTest,
                         ::testing::Values(std::pair(1, 0), std::pair(1, 3), std::pair(2, 2), std::pair(7, 0),
                                           std::pair(9, 5)));

TEST(BorderedSystem, RefusesIndefiniteMatrices) {
  BorderedSystem system = RandomSystem(3, 4, 2);
  system.diagonal[1].setZero();
  EXPECT_FALSE(system.Solve());
  EXPECT_FALSE(system.Invert());
  system = RandomSystem(3, 4, 2);
  system.corner.setZero();
  EXPECT_FALSE(system.Solve());
}

}  // namespace
}  // namespace victorious
