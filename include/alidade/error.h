#ifndef ALIDADE_ERROR_H_
#define ALIDADE_ERROR_H_

#include <stdexcept>
#include <string>

namespace alidade {

/// Where in the user's input something is wrong. Fields that do not apply are
/// empty or zero and are left out of the printed message.
struct SourceLocation {
  std::string file;
  int line = 0;     ///< 1-based; 0 = not known
  int column = 0;   ///< 1-based; 0 = not known
  std::string key;  ///< dotted path ("joints[2].limits") or CSV column name
};

/// The one error type for wrong input: a file, a flag or an option that the
/// user can mend. The program turns it into exit status 2.
///
/// what() is one line, "file:line:column: key: message". The message says
/// what was found, what was expected and what to do.
///
/// Numerical outcomes are not errors; a solver's Summary reports them.
/// Programming errors are CHECKed.
class InputError : public std::runtime_error {
 public:
  InputError(const SourceLocation& location, const std::string& message);

  const SourceLocation& location() const { return location_; }
  /// The message without its location.
  const std::string& message() const { return message_; }

 private:
  SourceLocation location_;
  std::string message_;
};

}  // namespace alidade

#endif  // ALIDADE_ERROR_H_
