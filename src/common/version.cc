#include "alidade/version.h"

namespace alidade {

const char* Version() { return ALIDADE_VERSION; }

}  // namespace alidade
