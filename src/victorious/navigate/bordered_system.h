// Normal equations of a chain of equal blocks with a border:
//
//   | D0 U0             B0 |   | x0 |   | g0 |
//   | .  D1 U1          B1 |   | x1 |   | g1 |
//   |    .  ..  ..      .. | * | .. | = | .. |     symmetric, positive definite
//   | .  .  ..          C  |   | y  |   | h  |
//
// x: what follows each other in time, each tied to the next alone; y: what all of them share. Solved by Cholesky's
// method from block to block, then for the border (Schur complement): linear in the number of blocks, and so are the
// blocks' covariances. Memory: blocks x block_size x border_size numbers.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace victorious {

class BorderedSystem {
 public:
  /// Some of a block's columns of the border.
  struct Part {
    Eigen::Index first = 0;
    Eigen::MatrixXd columns;  ///< block_size x any
  };

  BorderedSystem(std::size_t blocks, Eigen::Index block_size, Eigen::Index border_size);

  [[nodiscard]] std::size_t blocks() const { return diagonal.size(); }
  [[nodiscard]] Eigen::Index block_size() const { return block_size_; }
  [[nodiscard]] Eigen::Index border_size() const { return corner.rows(); }

  std::vector<Eigen::MatrixXd> diagonal;  ///< D, block_size x block_size
  std::vector<Eigen::MatrixXd> upper;     ///< U, one fewer: block k with block k + 1
  std::vector<std::vector<Part>> border;  ///< B, the sum of parts: most of it is 0
  std::vector<Eigen::VectorXd> right;     ///< g
  Eigen::MatrixXd corner;                 ///< C
  Eigen::VectorXd corner_right;           ///< h

  struct Solution {
    std::vector<Eigen::VectorXd> blocks;  ///< x
    Eigen::VectorXd border;               ///< y
  };
  /// @param damping  by so much of itself the whole matrix's diagonal is taken larger
  /// Nothing where the matrix is not positive definite.
  [[nodiscard]] std::optional<Solution> Solve(double damping = 0) const;

  struct Covariances {
    std::vector<Eigen::MatrixXd> blocks;  ///< of each x
    std::vector<Eigen::MatrixXd> cross;   ///< of each x with y
    Eigen::MatrixXd border;               ///< of y
  };
  /// The blocks on the diagonal of the inverse, and the border's columns. Nothing where it is not positive definite.
  [[nodiscard]] std::optional<Covariances> Invert() const;

 private:
  struct Factors;
  [[nodiscard]] std::optional<Factors> Factorise(double damping) const;

  Eigen::Index block_size_;
};

}  // namespace victorious
