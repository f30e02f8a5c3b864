// Whether the address sanitizer watches, which each compiler says in its own way: OPENCLOSE_ADDRESS_SANITIZER is defined if it does.
#pragma once

#if defined(__SANITIZE_ADDRESS__)
#define OPENCLOSE_ADDRESS_SANITIZER
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define OPENCLOSE_ADDRESS_SANITIZER
#endif
#endif
