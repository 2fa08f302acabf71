// What woven sources call: every operator that has a mutant becomes a call with
// the mutant's number, which does what the operator does unless that mutant is
// the active one. Included by the sources that mutate.py writes, by no others.
#ifndef ALIDADE_TESTS_MUTATION_MUTATION_H_
#define ALIDADE_TESTS_MUTATION_MUTATION_H_

#include <cstdlib>
#include <functional>
#include <type_traits>
#include <utility>

namespace alidade_mutation {

// Numbers of mutants are below.
inline constexpr int kMostMutants = 1 << 18;

inline int NumberOf(const char* variable) {
  const char* const text = std::getenv(variable);
  return text == nullptr ? 0 : std::atoi(text);
}

inline const int active = NumberOf("ALIDADE_MUTANT");
inline const bool records = std::getenv("ALIDADE_MUTANTS_REACHED") != nullptr;
// Which mutants were come across since the recorder (recorder.cc) looked last.
inline unsigned char reached[kMostMutants] = {};

inline bool Active(int id) {
  if (records) reached[id] = 1;
  return id == active;
}

inline double Sign(int id) { return Active(id) ? -1.0 : 1.0; }

template <typename T>
T Literal(int id, T value, T mutated) {
  return Active(id) ? mutated : value;
}

template <typename T>
bool Not(int id, const T& value) {
  return !value != Active(id);
}

template <typename T>
auto Negate(int id, const T& value) {
  using Result = decltype(-value);
  if constexpr (std::is_arithmetic_v<T> || std::is_same_v<Result, T>) {
    return Active(id) ? static_cast<Result>(value) : -value;
  } else {  // an expression of matrices
    return -(static_cast<typename T::Scalar>(Sign(id)) * value);
  }
}

// Whether both operators take these operands and give one type.
template <typename First, typename Second, typename A, typename B,
          typename = void>
inline constexpr bool kAreAlike = false;
template <typename First, typename Second, typename A, typename B>
inline constexpr bool
    kAreAlike<First, Second, A, B,
              std::void_t<std::invoke_result_t<First, A, B>,
                          std::invoke_result_t<Second, A, B>>> =
        std::is_same_v<std::invoke_result_t<First, A, B>,
                       std::invoke_result_t<Second, A, B>>;

// `First` of both operands, or `Second` where the mutant is active.
template <typename First, typename Second, typename A, typename B>
std::invoke_result_t<First, A, B> Choose(int id, A&& a, B&& b) {
  if (Active(id)) return Second()(std::forward<A>(a), std::forward<B>(b));
  return First()(std::forward<A>(a), std::forward<B>(b));
}

template <typename T>
using ScalarOf = typename std::decay_t<T>::Scalar;

// Sums and products of matrices are types of their own, which differ from those
// of differences and quotients: an operand takes the sign, or is inverted.
template <typename A, typename B>
auto Plus(int id, A&& a, B&& b) {
  if constexpr (kAreAlike<std::plus<>, std::minus<>, A, B>) {
    return Choose<std::plus<>, std::minus<>>(id, std::forward<A>(a),
                                             std::forward<B>(b));
  } else {
    return a + static_cast<ScalarOf<B>>(Sign(id)) * b;
  }
}

template <typename A, typename B>
auto Minus(int id, A&& a, B&& b) {
  if constexpr (kAreAlike<std::plus<>, std::minus<>, A, B>) {
    return Choose<std::minus<>, std::plus<>>(id, std::forward<A>(a),
                                             std::forward<B>(b));
  } else {
    return a - static_cast<ScalarOf<B>>(Sign(id)) * b;
  }
}

template <typename T>
T Inverse(int id, const T& value) {
  return Active(id) ? T(1) / value : value;
}

template <typename A, typename B>
auto Times(int id, A&& a, B&& b) {
  if constexpr (kAreAlike<std::multiplies<>, std::divides<>, A, B>) {
    return Choose<std::multiplies<>, std::divides<>>(id, std::forward<A>(a),
                                                     std::forward<B>(b));
  } else if constexpr (std::is_arithmetic_v<std::decay_t<A>>) {
    return Inverse(id, static_cast<ScalarOf<B>>(a)) * b;
  } else if constexpr (std::is_arithmetic_v<std::decay_t<B>>) {
    return a * Inverse(id, static_cast<ScalarOf<A>>(b));
  } else {  // of two matrices the negative, which must not refer to a product
    return (static_cast<ScalarOf<A>>(Sign(id)) * (a * b)).eval();
  }
}

template <typename A, typename B>
auto Over(int id, A&& a, B&& b) {
  if constexpr (kAreAlike<std::multiplies<>, std::divides<>, A, B>) {
    return Choose<std::divides<>, std::multiplies<>>(id, std::forward<A>(a),
                                                     std::forward<B>(b));
  } else {
    return a / Inverse(id, static_cast<ScalarOf<A>>(b));
  }
}

template <typename A, typename B>
decltype(auto) PlusAssign(int id, A&& a, B&& b) {
  if (Active(id)) return a -= std::forward<B>(b);
  return a += std::forward<B>(b);
}

template <typename A, typename B>
decltype(auto) MinusAssign(int id, A&& a, B&& b) {
  if (Active(id)) return a += std::forward<B>(b);
  return a -= std::forward<B>(b);
}

template <typename A, typename B>
decltype(auto) TimesAssign(int id, A&& a, B&& b) {
  if (Active(id)) return a /= std::forward<B>(b);
  return a *= std::forward<B>(b);
}

template <typename A, typename B>
decltype(auto) OverAssign(int id, A&& a, B&& b) {
  if (Active(id)) return a *= std::forward<B>(b);
  return a /= std::forward<B>(b);
}

}  // namespace alidade_mutation

#endif  // ALIDADE_TESTS_MUTATION_MUTATION_H_
