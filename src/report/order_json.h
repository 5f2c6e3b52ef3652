// The JSON of one ordered file, which the report of many files repeats.
#pragma once

#include "json.h"
#include "pellucid/report.h"

namespace pellucid {

Json json_of(const OrderReport& report);

}  // namespace pellucid
