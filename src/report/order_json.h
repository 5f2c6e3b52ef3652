// The JSON of one ordered file, which the report of many files repeats.
#pragma once

#include "pellucid/report.h"
#include "report/json.h"

namespace pellucid {

Json json_of(const OrderReport& report);

}  // namespace pellucid
