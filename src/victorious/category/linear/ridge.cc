#include "victorious/category/linear/ridge.h"

#include <map>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "victorious/base/check.h"

namespace victorious {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd RegularisedInverse(MatrixXd kernel, const VectorXd& penalty) {
  kernel.diagonal() += penalty;
  return kernel.llt().solve(MatrixXd::Identity(kernel.rows(), kernel.cols()));
}

RidgeFit FitRidge(const MatrixXd& kernel, const Eigen::MatrixXi& targets, std::span<const int> group,
                  const VectorXd& penalty) {
  const Index all = kernel.rows();
  VICTORIOUS_CHECK(all == targets.rows() && all == penalty.size() && static_cast<std::size_t>(all) == group.size());
  std::vector<Index> used;
  std::map<int, std::vector<Index>> used_of_group;  // group id to indices into `used`
  for (Index i = 0; i < all; ++i) {
    const bool learned = (targets.row(i).array() != 0).all();
    VICTORIOUS_CHECK(learned || (targets.row(i).array() == 0).all());
    if (!learned) continue;
    used_of_group[group[static_cast<std::size_t>(i)]].push_back(static_cast<Index>(used.size()));
    used.push_back(i);
  }
  const MatrixXd inverse = RegularisedInverse(kernel(used, used), penalty(used));
  const MatrixXd alpha = inverse * targets(used, Eigen::all).cast<double>();

  RidgeFit fit{.alpha = MatrixXd::Zero(all, targets.cols()), .held_out = kernel(Eigen::all, used) * alpha};
  fit.alpha(used, Eigen::all) = alpha;
  std::map<int, std::vector<Index>> all_of_group;
  for (Index i = 0; i < all; ++i) all_of_group[group[static_cast<std::size_t>(i)]].push_back(i);
  for (const auto& [number, members] : used_of_group) {
    // Block-wise leave-one-group-out: alpha_-g = alpha - inverse(:, g) inverse(g, g)^-1 alpha(g).
    const MatrixXd own = MatrixXd(inverse(members, members)).lu().solve(MatrixXd(alpha(members, Eigen::all)));
    const MatrixXd without = alpha - inverse(Eigen::all, members) * own;
    const std::vector<Index>& held_out = all_of_group[number];
    fit.held_out(held_out, Eigen::all) = kernel(held_out, used) * without;
  }
  return fit;
}

}  // namespace victorious
