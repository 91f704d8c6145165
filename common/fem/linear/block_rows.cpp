#include "common/fem/linear/block_rows.h"

#include <cstring>

// The compiler makes one version for the instructions that all processors have and one for those of
// the last ten years; the right one is chosen when the program starts. Both round alike.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define MORTISE_VERSIONS __attribute__((target_clones("avx2", "default")))
#else
#define MORTISE_VERSIONS
#endif

namespace mortise::simulator {
namespace {

typedef double Double4 __attribute__((vector_size(32)));
typedef float Float4 __attribute__((vector_size(16)));

// The columns of a block are read four numbers at a time; the fourth belongs to the next column,
// and what it adds to is dropped. So the last block, which nothing follows, is read carefully.
MORTISE_VERSIONS void Multiply(const int* starts, const int* columns, const float* blocks,
                               const double* x, double* y, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    Double4 sum = {0, 0, 0, 0};
    for (int k = starts[i]; k < starts[i + 1] - 1; ++k) {
      const float* block = blocks + std::size_t(9) * k;
      const double* of = x + std::size_t(3) * columns[k];
      Float4 c0, c1, c2;
      std::memcpy(&c0, block, sizeof(c0));
      std::memcpy(&c1, block + 3, sizeof(c1));
      std::memcpy(&c2, block + 6, sizeof(c2));
      sum += __builtin_convertvector(c0, Double4) * of[0] +
             __builtin_convertvector(c1, Double4) * of[1] +
             __builtin_convertvector(c2, Double4) * of[2];
    }
    const float* last = blocks + std::size_t(9) * (starts[i + 1] - 1);
    const double* of = x + std::size_t(3) * columns[starts[i + 1] - 1];
    for (int a = 0; a < 3; ++a) {
      y[std::size_t(3) * i + a] =
          sum[a] + (last[a] * of[0] + last[3 + a] * of[1] + last[6 + a] * of[2]);
    }
  }
}

MORTISE_VERSIONS void Multiply(const int* starts, const int* columns, const double* blocks,
                               const double* x, double* y, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    Double4 sum = {0, 0, 0, 0};
    for (int k = starts[i]; k < starts[i + 1] - 1; ++k) {
      const double* block = blocks + std::size_t(9) * k;
      const double* of = x + std::size_t(3) * columns[k];
      Double4 c0, c1, c2;
      std::memcpy(&c0, block, sizeof(c0));
      std::memcpy(&c1, block + 3, sizeof(c1));
      std::memcpy(&c2, block + 6, sizeof(c2));
      sum += c0 * of[0] + c1 * of[1] + c2 * of[2];
    }
    const double* last = blocks + std::size_t(9) * (starts[i + 1] - 1);
    const double* of = x + std::size_t(3) * columns[starts[i + 1] - 1];
    for (int a = 0; a < 3; ++a) {
      y[std::size_t(3) * i + a] =
          sum[a] + (last[a] * of[0] + last[3 + a] * of[1] + last[6 + a] * of[2]);
    }
  }
}

// Whole blocks only, for the last column, which no other memory follows.
void MultiplyLastColumn(const BlockPattern& pattern, const double* blocks, const double* x,
                        double* y) {
  const int v = pattern.nodes() - 1;
  double sum[3] = {0, 0, 0};
  for (int k = pattern.starts()[v]; k < pattern.starts()[v + 1]; ++k) {
    const double* block = blocks + std::size_t(9) * k;
    const double* of = x + std::size_t(3) * pattern.rows()[k];
    for (int a = 0; a < 3; ++a) {
      sum[a] += block[3 * a] * of[0] + block[3 * a + 1] * of[1] + block[3 * a + 2] * of[2];
    }
  }
  for (int a = 0; a < 3; ++a) y[std::size_t(3) * v + a] = sum[a];
}

// Rows begin … end − 1, none of them the last.
MORTISE_VERSIONS void MultiplyUpper(const int* starts, const int* rows, const int* row_starts,
                                    const int* row_columns, const int* row_slots,
                                    const double* blocks, const double* x, double* y, int begin,
                                    int end) {
  for (int v = begin; v < end; ++v) {
    // Blocks of the column, transposed: scalar products with the columns of each, added at the end.
    Double4 s0 = {0, 0, 0, 0}, s1 = s0, s2 = s0, sum = s0;
    for (int k = starts[v]; k < starts[v + 1]; ++k) {
      const double* block = blocks + std::size_t(9) * k;
      Double4 of, c0, c1, c2;
      std::memcpy(&of, x + std::size_t(3) * rows[k], sizeof(of));
      std::memcpy(&c0, block, sizeof(c0));
      std::memcpy(&c1, block + 3, sizeof(c1));
      std::memcpy(&c2, block + 6, sizeof(c2));
      s0 += c0 * of;
      s1 += c1 * of;
      s2 += c2 * of;
    }
    for (int k = row_starts[v]; k < row_starts[v + 1]; ++k) {
      const double* block = blocks + std::size_t(9) * row_slots[k];
      const double* of = x + std::size_t(3) * row_columns[k];
      Double4 c0, c1, c2;
      std::memcpy(&c0, block, sizeof(c0));
      std::memcpy(&c1, block + 3, sizeof(c1));
      std::memcpy(&c2, block + 6, sizeof(c2));
      sum += c0 * of[0] + c1 * of[1] + c2 * of[2];
    }
    double* to = y + std::size_t(3) * v;
    to[0] = sum[0] + (s0[0] + s0[1] + s0[2]);
    to[1] = sum[1] + (s1[0] + s1[1] + s1[2]);
    to[2] = sum[2] + (s2[0] + s2[1] + s2[2]);
  }
}

}  // namespace

void MultiplySymmetric(const BlockPattern& pattern, const double* blocks, const double* x,
                       double* y, int begin, int end) {
  const int last = pattern.nodes() - 1;
  MultiplyUpper(pattern.starts().data(), pattern.rows().data(), pattern.row_starts().data(),
                pattern.row_columns().data(), pattern.row_slots().data(), blocks, x, y, begin,
                std::min(end, last));
  if (begin <= last && last < end) MultiplyLastColumn(pattern, blocks, x, y);
}

void MultiplyRows(const BlockRows<float, 3, 3>& a, const double* x, double* y, int begin, int end) {
  Multiply(a.starts.data(), a.columns.data(), a.blocks.front().data(), x, y, begin, end);
}

void MultiplyRows(const BlockRows<double, 3, 3>& a, const double* x, double* y, int begin,
                  int end) {
  Multiply(a.starts.data(), a.columns.data(), a.blocks.front().data(), x, y, begin, end);
}

}  // namespace mortise::simulator
