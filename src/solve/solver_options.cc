#include "alidade/solver_options.h"

#include "src/solve/solver_options_fields.h"

namespace alidade {

bool SolverOptions::IsValid(std::string* error) const {
  internal::FieldCheck threads("");
  threads.Field(internal::Key("num_threads").AtLeast(1), num_threads, "");
  *error = threads.error();
  return internal::AreFieldsValid(*this, "", error) && error->empty();
}

}  // namespace alidade
