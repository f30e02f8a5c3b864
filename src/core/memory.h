// How much memory a simulation's arrays take, by what they are for.
#pragma once

#include <algorithm>
#include <cstddef>

namespace openclose {

/// [bytes] What a scene takes at least, by which it is judged before the memory is taken: cutting 250,000 squares out of a domain peaks at 0.75 kB
/// for each of them, settling 40,000 at 13 kB for each with its four vertices.
inline constexpr std::size_t bytes_of_cut_block = 1000, bytes_of_simulated_block = 6000, bytes_of_simulated_vertex = 1000;

/// [bytes] Room of arrays, used or not.
struct Memory {
  std::size_t blocks = 0;    ///< the scene, and what there is of every block
  std::size_t contacts = 0;  ///< candidates, contacts with their history, and what a step has of them
  std::size_t matrix = 0;    ///< of a step: pattern and numbers
  std::size_t factor = 0;    ///< of a matrix, complete or not, with its order and pattern
  std::size_t krylov = 0;    ///< basis of GMRES

  Memory& operator+=(const Memory& other) {
    blocks += other.blocks, contacts += other.contacts, matrix += other.matrix, factor += other.factor, krylov += other.krylov;
    return *this;
  }
  friend Memory operator+(Memory a, const Memory& b) { return a += b; }
  /// Each part for itself.
  void grow_to(const Memory& other) {
    blocks = std::max(blocks, other.blocks);
    contacts = std::max(contacts, other.contacts);
    matrix = std::max(matrix, other.matrix);
    factor = std::max(factor, other.factor);
    krylov = std::max(krylov, other.krylov);
  }
  std::size_t without_factor() const { return blocks + contacts + matrix; }
};

/// [bytes] Of std::vectors.
template <class... Vectors>
std::size_t bytes_of(const Vectors&... vectors) {
  return (std::size_t{0} + ... + (vectors.capacity() * sizeof(typename Vectors::value_type)));
}

/// Resizes a vector that has found its size and now and then needs a little more: it does not double then.
template <class Vector>
void resize_closely(Vector& vector, std::size_t size) {
  constexpr std::size_t part_to_spare = 16;
  if (vector.capacity() < size) vector.reserve(size + size / part_to_spare);
  vector.resize(size);
}

}  // namespace openclose
