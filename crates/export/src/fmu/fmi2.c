/* FMI 2.0: model exchange and co-simulation of the model in model.h. The types are those of the standard's headers. */
#include "model.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#if defined _WIN32
#define FMI2 __declspec(dllexport)
#else
#define FMI2 __attribute__((visibility("default")))
#endif

typedef void *fmi2Component;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef const char *fmi2String;
typedef char fmi2Byte;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef int fmi2StatusKind;
typedef struct {
    fmi2Boolean newDiscreteStatesNeeded;
    fmi2Boolean terminateSimulation;
    fmi2Boolean nominalsOfContinuousStatesChanged;
    fmi2Boolean valuesOfContinuousStatesChanged;
    fmi2Boolean nextEventTimeDefined;
    double nextEventTime;
} fmi2EventInfo;

static fmi2Status status_of(int ok)
{
    return ok ? fmi2OK : fmi2Error;
}

FMI2 const char *fmi2GetTypesPlatform(void)
{
    return "default";
}

FMI2 const char *fmi2GetVersion(void)
{
    return "2.0";
}

FMI2 fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    (void)c; (void)on; (void)n; (void)categories;
    return fmi2OK;
}

FMI2 fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String token, fmi2String resources,
                                   const void *callbacks, fmi2Boolean visible, fmi2Boolean logging)
{
    model *m;
    (void)name; (void)type; (void)resources; (void)callbacks; (void)visible; (void)logging;
    if (token == NULL || strcmp(token, MODEL_TOKEN) != 0) {
        return NULL;
    }
    m = (model *)calloc(1, sizeof *m);
    if (m != NULL) {
        model_reset(m);
    }
    return m;
}

FMI2 void fmi2FreeInstance(fmi2Component c)
{
    free(c);
}

FMI2 fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, double tolerance, double start,
                                    fmi2Boolean has_stop, double stop)
{
    (void)has_tolerance; (void)tolerance; (void)has_stop; (void)stop;
    ((model *)c)->time = start;
    return fmi2OK;
}

#define NOTHING(name) \
    FMI2 fmi2Status name(fmi2Component c) \
    { \
        (void)c; \
        return fmi2OK; \
    }
NOTHING(fmi2EnterInitializationMode)
NOTHING(fmi2Terminate)
NOTHING(fmi2EnterEventMode)
NOTHING(fmi2EnterContinuousTimeMode)

FMI2 fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    model_count_periods((model *)c);
    return fmi2OK;
}

FMI2 fmi2Status fmi2Reset(fmi2Component c)
{
    model_reset((model *)c);
    return fmi2OK;
}

FMI2 fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, double values[])
{
    size_t i;
    for (i = 0; i < n; i++) {
        if (!model_get((model *)c, vr[i], &values[i])) {
            return fmi2Error;
        }
    }
    return fmi2OK;
}

FMI2 fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const double values[])
{
    size_t i;
    for (i = 0; i < n; i++) {
        if (!model_set((model *)c, vr[i], values[i])) {
            return fmi2Error;
        }
    }
    return fmi2OK;
}

FMI2 fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Integer values[])
{
    size_t i;
    for (i = 0; i < n; i++) {
        if (vr[i] != MODEL_PERIODS_REFERENCE) {
            return fmi2Error;
        }
        values[i] = ((model *)c)->periods;
    }
    return fmi2OK;
}

/* The model has no variables of these types. */
#define NO_VARIABLES(name, type) \
    FMI2 fmi2Status name(fmi2Component c, const fmi2ValueReference vr[], size_t n, type values[]) \
    { \
        (void)c; (void)vr; (void)values; \
        return status_of(n == 0); \
    }
NO_VARIABLES(fmi2GetBoolean, fmi2Boolean)
NO_VARIABLES(fmi2GetString, fmi2String)
NO_VARIABLES(fmi2SetInteger, const fmi2Integer)
NO_VARIABLES(fmi2SetBoolean, const fmi2Boolean)
NO_VARIABLES(fmi2SetString, const fmi2String)

FMI2 fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    if (*state == NULL) {
        *state = malloc(sizeof(model));
    }
    if (*state == NULL) {
        return fmi2Error;
    }
    memcpy(*state, c, sizeof(model));
    return fmi2OK;
}

FMI2 fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    memcpy(c, state, sizeof(model));
    return fmi2OK;
}

FMI2 fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    (void)c;
    free(*state);
    *state = NULL;
    return fmi2OK;
}

FMI2 fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    (void)c; (void)state;
    *size = sizeof(model);
    return fmi2OK;
}

FMI2 fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    (void)c;
    if (size != sizeof(model)) {
        return fmi2Error;
    }
    memcpy(bytes, state, size);
    return fmi2OK;
}

FMI2 fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
    (void)c;
    if (size != sizeof(model)) {
        return fmi2Error;
    }
    if (*state == NULL) {
        *state = malloc(size);
    }
    if (*state == NULL) {
        return fmi2Error;
    }
    memcpy(*state, bytes, size);
    return fmi2OK;
}

FMI2 fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknowns[], size_t n,
                                             const fmi2ValueReference knowns[], size_t n_knowns, const double seed[],
                                             double sensitivity[])
{
    return status_of(model_directional((const model *)c, unknowns, n, knowns, n_knowns, seed, sensitivity));
}

FMI2 fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info)
{
    model_count_periods((model *)c);
    memset(info, 0, sizeof *info);
    return fmi2OK;
}

FMI2 fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean no_rollback, fmi2Boolean *enter_event_mode,
                                            fmi2Boolean *terminate)
{
    (void)c; (void)no_rollback;
    *enter_event_mode = *terminate = 0;
    return fmi2OK;
}

FMI2 fmi2Status fmi2SetTime(fmi2Component c, double time)
{
    ((model *)c)->time = time;
    return fmi2OK;
}

FMI2 fmi2Status fmi2SetContinuousStates(fmi2Component c, const double x[], size_t n)
{
    if (n != MODEL_STATES) {
        return fmi2Error;
    }
    model_set_states((model *)c, x);
    return fmi2OK;
}

FMI2 fmi2Status fmi2GetDerivatives(fmi2Component c, double rates[], size_t n)
{
    return status_of(n == MODEL_STATES && model_rates((const model *)c, rates));
}

FMI2 fmi2Status fmi2GetEventIndicators(fmi2Component c, double indicators[], size_t n)
{
    if (n != MODEL_INDICATORS) {
        return fmi2Error;
    }
    model_indicators((const model *)c, indicators);
    return fmi2OK;
}

FMI2 fmi2Status fmi2GetContinuousStates(fmi2Component c, double x[], size_t n)
{
    if (n != MODEL_STATES) {
        return fmi2Error;
    }
    model_states((const model *)c, x);
    return fmi2OK;
}

FMI2 fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, double nominals[], size_t n)
{
    size_t i;
    (void)c;
    for (i = 0; i < n; i++) {
        nominals[i] = 1;
    }
    return status_of(n == MODEL_STATES);
}

FMI2 fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                            const fmi2Integer orders[], const double values[])
{
    (void)c; (void)vr; (void)n; (void)orders; (void)values;
    return fmi2Error;
}

FMI2 fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                             const fmi2Integer orders[], double values[])
{
    (void)c; (void)vr; (void)n; (void)orders; (void)values;
    return fmi2Error;
}

FMI2 fmi2Status fmi2DoStep(fmi2Component c, double time, double step, fmi2Boolean no_rollback)
{
    (void)no_rollback;
    return status_of(model_advance((model *)c, time, step));
}

FMI2 fmi2Status fmi2CancelStep(fmi2Component c)
{
    (void)c;
    return fmi2Error;
}

FMI2 fmi2Status fmi2GetStatus(fmi2Component c, fmi2StatusKind kind, fmi2Status *value)
{
    (void)c; (void)kind; (void)value;
    return fmi2Discard;
}

FMI2 fmi2Status fmi2GetRealStatus(fmi2Component c, fmi2StatusKind kind, double *value)
{
    (void)c; (void)kind; (void)value;
    return fmi2Discard;
}

FMI2 fmi2Status fmi2GetIntegerStatus(fmi2Component c, fmi2StatusKind kind, fmi2Integer *value)
{
    (void)c; (void)kind; (void)value;
    return fmi2Discard;
}

FMI2 fmi2Status fmi2GetBooleanStatus(fmi2Component c, fmi2StatusKind kind, fmi2Boolean *value)
{
    (void)c; (void)kind; (void)value;
    return fmi2Discard;
}

FMI2 fmi2Status fmi2GetStringStatus(fmi2Component c, fmi2StatusKind kind, fmi2String *value)
{
    (void)c; (void)kind; (void)value;
    return fmi2Discard;
}
