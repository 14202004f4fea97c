/* The version of kage. */
#ifndef KAGE_BASE_VERSION_H
#define KAGE_BASE_VERSION_H

#define KAGE_VERSION "0.1.0"

#endif
