#include "openclose/integrator/parts.h"

#include <algorithm>
#include <cmath>

#include "openclose/core/vector.h"

namespace openclose {

Eigen::VectorXd rows_of(const Eigen::VectorXd& whole, const std::vector<int>& rows) {
  Eigen::VectorXd part(dofs * static_cast<Eigen::Index>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) part.segment<dofs>(dofs * i) = whole.segment<dofs>(dofs * rows[i]);
  return part;
}

std::vector<int> most_unbalanced(const std::vector<double>& residuals, double largest, double end, double part, int few) {
  if (!std::isfinite(largest)) return {};
  const auto beyond = [&](double limit) {
    std::vector<int> rows;
    for (std::size_t row = 0; row < residuals.size(); ++row) {
      if (residuals[row] > limit) rows.push_back(static_cast<int>(row));
    }
    return rows;
  };
  double limit = std::max(end, part * largest);
  std::vector<int> rows = beyond(limit);
  while (limit > end) {
    limit = std::max(end, part * limit);
    std::vector<int> more = beyond(limit);
    if (static_cast<int>(more.size()) > few) break;
    rows = std::move(more);
  }
  return rows;
}

std::vector<Part> Neighbourhood::parts(const std::vector<int>& seeds, int rings, int largest) const {
  std::vector<int> ring(rows(), -1);
  const std::vector<int> blocks = grow(seeds, rings, ring);
  std::vector<Part> parts;
  for (int first : blocks) {
    if (ring[first] < 0) continue;
    Part part = take(first, ring);
    if (static_cast<int>(part.rows.size()) <= largest) parts.push_back(std::move(part));
  }
  std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.rows.size() < b.rows.size(); });
  return parts;
}

std::vector<int> Neighbourhood::grow(const std::vector<int>& seeds, int rings, std::vector<int>& ring) const {
  std::vector<int> blocks = seeds;
  for (int row : seeds) ring[row] = 0;
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const int row = blocks[k];
    if (ring[row] == rings) break;
    for (int e = first_[row]; e < first_[row + 1]; ++e) {
      const int other = ends_[e].other;
      if (other >= rows() || ring[other] >= 0) continue;
      ring[other] = ring[row] + 1;
      blocks.push_back(other);
    }
  }
  return blocks;
}

Part Neighbourhood::take(int first, std::vector<int>& ring) const {
  Part part{{first}, {}};
  ring[first] = -1;
  for (std::size_t k = 0; k < part.rows.size(); ++k) {
    const int row = part.rows[k];
    for (int e = first_[row]; e < first_[row + 1]; ++e) {
      const auto& [contact, other] = ends_[e];
      part.contacts.push_back(contact);
      if (other >= rows() || ring[other] < 0) continue;
      ring[other] = -1;
      part.rows.push_back(other);
    }
  }
  std::sort(part.rows.begin(), part.rows.end());
  std::sort(part.contacts.begin(), part.contacts.end());
  part.contacts.erase(std::unique(part.contacts.begin(), part.contacts.end()), part.contacts.end());
  return part;
}

}  // namespace openclose
