// Normal equations of a chain of equal blocks with a border (arrow matrix), used by smoother.h:
//
//   | D0 U0             B0 |   | x0 |   | g0 |
//   | .  D1 U1          B1 |   | x1 |   | g1 |
//   |    .  ..  ..      .. | * | .. | = | .. |     symmetric, positive definite
//   | .  .  ..          C  |   | y  |   | h  |
//
// x: the states of successive frames, each coupled only to the next; y: the unknowns shared by all frames. Solved by
// block Cholesky factorisation along the chain and the Schur complement for the border. Time is linear in the number of
// blocks, also for the blocks' covariances. Memory: blocks x block_size x border_size numbers.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace victorious {

class BorderedSystem {
 public:
  /// Some columns of a block's part of the border.
  struct Part {
    Eigen::Index first = 0;
    Eigen::MatrixXd columns;  ///< block_size x any number
  };

  BorderedSystem(std::size_t blocks, Eigen::Index block_size, Eigen::Index border_size);

  [[nodiscard]] std::size_t blocks() const { return diagonal.size(); }
  [[nodiscard]] Eigen::Index block_size() const { return block_size_; }
  [[nodiscard]] Eigen::Index border_size() const { return corner.rows(); }

  std::vector<Eigen::MatrixXd> diagonal;  ///< D, block_size x block_size
  std::vector<Eigen::MatrixXd> upper;     ///< U, one fewer: couples block k with block k + 1
  std::vector<std::vector<Part>> border;  ///< B, as a sum of parts: sparse
  std::vector<Eigen::VectorXd> rhs;       ///< g
  Eigen::MatrixXd corner;                 ///< C
  Eigen::VectorXd corner_rhs;             ///< h

  struct Solution {
    std::vector<Eigen::VectorXd> blocks;  ///< x
    Eigen::VectorXd border;               ///< y
  };
  /// Solves the system.
  /// @param damping  relative increase of the matrix's diagonal (Levenberg-Marquardt)
  /// @return std::nullopt if the matrix is not positive definite
  [[nodiscard]] std::optional<Solution> Solve(double damping = 0) const;

  struct Covariances {
    std::vector<Eigen::MatrixXd> blocks;  ///< of each x
    std::vector<Eigen::MatrixXd> cross;   ///< cross-covariance of each x with y
    Eigen::MatrixXd border;               ///< of y
  };
  /// The diagonal blocks and the border's columns of the inverse; std::nullopt if the matrix is not positive definite.
  [[nodiscard]] std::optional<Covariances> Invert() const;

 private:
  struct Factors;
  [[nodiscard]] std::optional<Factors> Factorise(double damping) const;

  Eigen::Index block_size_;
};

}  // namespace victorious
