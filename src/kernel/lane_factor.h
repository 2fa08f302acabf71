#ifndef ALIDADE_SRC_KERNEL_LANE_FACTOR_H_
#define ALIDADE_SRC_KERNEL_LANE_FACTOR_H_

#include <Eigen/Core>
#include <cstddef>

// Triangular factors and Gram matrices of tall matrices, by vector code that
// needs no sum across a vector: each lane keeps a factor of its own of the rows
// that came by in it. What all lanes hold is merged once, at the end.
//
// A matrix of `rows` vectors by `columns` is stored column by column, `rows`
// vectors each. An upper triangle is stored row by row, a vector for each
// entry. All arrays are aligned to 64 bytes.
namespace alidade::internal::kernel {

/// Lanes of a vector of doubles on this machine.
std::size_t Lanes();

/// What vector code uses on this machine: "AVX2".
const char* TargetName();

/// Doubles of an upper triangle of so many columns, one for each lane.
std::size_t TriangleSize(int columns);

/// triangle <- R of [triangle; matrix], lane by lane, by Householder
/// transformations two columns at a time (Bischof and Van Loan 1987, "The WY
/// representation for products of Householder matrices"). `matrix` (rows x
/// columns vectors, `stride` doubles from column to column) is overwritten.
/// About rows columns^2 multiply-adds of vectors.
void AddRows(int columns, int rows, std::size_t stride, double* matrix,
             double* triangle);

/// triangle <- R of [triangle; other].
/// `work`: MergeSize(columns) doubles, overwritten.
void MergeTriangles(int columns, const double* other, double* work,
                    double* triangle);
std::size_t MergeSize(int columns);

/// R of all lanes, columns x columns. `triangle` and `work` are overwritten.
void MergeLanes(int columns, double* triangle, double* work,
                Eigen::MatrixXd* factor);

/// triangle <- triangle + matrix^T matrix, lane by lane; the matrix stays.
/// About rows columns^2 / 2 multiply-adds of vectors.
void AddProducts(int columns, int rows, std::size_t stride, double* matrix,
                 double* triangle);

/// The sum of all lanes, columns x columns; its upper triangle is filled.
void SumLanes(int columns, const double* triangle, Eigen::MatrixXd* sum);

}  // namespace alidade::internal::kernel

#endif  // ALIDADE_SRC_KERNEL_LANE_FACTOR_H_
