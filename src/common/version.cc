#include "alidade/version.h"

namespace alidade {

const char* Version() { return ALIDADE_VERSION; }

const char* BuildDescription() { return ALIDADE_BUILD_DESCRIPTION; }

}  // namespace alidade
