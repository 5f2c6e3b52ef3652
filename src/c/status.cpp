// Errors and version of the C interface.
#include <new>
#include <stdexcept>

#include "c/handles.h"

namespace pellucid::c {
namespace {

// Short enough to need no allocation when memory has run out.
thread_local char last_error[1024] = "";

PellucidStatus status_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::bad_argument:
      return pellucid_bad_argument;
    case ErrorKind::bad_input:
      return pellucid_bad_input;
    case ErrorKind::nothing_to_do:
      return pellucid_nothing_to_do;
    case ErrorKind::cannot_write:
      return pellucid_cannot_write;
    case ErrorKind::interrupted:
      return pellucid_cancelled;
    case ErrorKind::quality_missed:
    case ErrorKind::internal:
      break;
  }
  return pellucid_internal;
}

}  // namespace

PellucidStatus fail(PellucidStatus status, const char* text) noexcept {
  std::strncpy(last_error, text, sizeof last_error - 1);
  return status;
}

PellucidStatus fail_with_current_exception() noexcept {
  try {
    throw;
  } catch (const Error& error) {
    return fail(status_of(error.kind()), error.what());
  } catch (const std::bad_alloc&) {
    return fail(pellucid_out_of_memory, "there is not enough memory");
  } catch (const std::length_error&) {
    return fail(pellucid_out_of_memory, "an array is larger than memory can be");
  } catch (const std::exception& error) {
    return fail(pellucid_internal, error.what());
  } catch (...) {
    return fail(pellucid_internal, "an unknown failure");
  }
}

}  // namespace pellucid::c

const char* pellucid_last_error(void) {
  return pellucid::c::last_error;
}

const char* pellucid_version(void) {
  return PELLUCID_VERSION;
}
