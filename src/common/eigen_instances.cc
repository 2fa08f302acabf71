#include "src/common/eigen_instances.h"

ALIDADE_EIGEN_INSTANCES(template)
