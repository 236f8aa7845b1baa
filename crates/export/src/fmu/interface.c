/* FMI @v@.0: model exchange and co-simulation of the model in model.h. The types are those of the standard's headers. */
#include "model.h"

2|#include <stddef.h>
2|#include <stdlib.h>
2|#include <string.h>
2|
3|#include <stdbool.h>
3|#include <stddef.h>
3|#include <stdint.h>
3|#include <stdlib.h>
3|#include <string.h>
3|
#if defined _WIN32
#define FMI@v@ __declspec(dllexport)
#else
#define FMI@v@ __attribute__((visibility("default")))
#endif

2|typedef void *fmi2Component;
2|typedef void *fmi2FMUstate;
2|typedef unsigned int fmi2ValueReference;
2|typedef int fmi2Integer;
2|typedef int fmi2Boolean;
2|typedef const char *fmi2String;
2|typedef char fmi2Byte;
2|typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
2|typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
2|typedef int fmi2StatusKind;
2|typedef struct {
2|    fmi2Boolean newDiscreteStatesNeeded;
2|    fmi2Boolean terminateSimulation;
2|    fmi2Boolean nominalsOfContinuousStatesChanged;
2|    fmi2Boolean valuesOfContinuousStatesChanged;
2|    fmi2Boolean nextEventTimeDefined;
2|    double nextEventTime;
2|} fmi2EventInfo;
2|
3|typedef void *fmi3Instance;
3|typedef void *fmi3InstanceEnvironment;
3|typedef void *fmi3FMUState;
3|typedef uint32_t fmi3ValueReference;
3|typedef const char *fmi3String;
3|typedef bool fmi3Boolean;
3|typedef bool fmi3Clock;
3|typedef const uint8_t *fmi3Binary;
3|typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
3|typedef int fmi3DependencyKind;
3|typedef int fmi3IntervalQualifier;
3|typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String, fmi3String);
3|typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment, double, bool, bool, bool, bool, bool, bool *, double *);
3|typedef void (*fmi3ClockUpdateCallback)(fmi3InstanceEnvironment);
3|typedef void (*fmi3LockPreemptionCallback)(void);
3|
static fmi@v@Status status_of(int ok)
{
    return ok ? fmi@v@OK : fmi@v@Error;
}

2|FMI2 const char *fmi2GetTypesPlatform(void)
2|{
2|    return "default";
2|}
2|
FMI@v@ const char *fmi@v@GetVersion(void)
{
    return "@v@.0";
}

FMI@v@ fmi@v@Status fmi@v@SetDebugLogging(@instance@ c, fmi@v@Boolean on, size_t n, const fmi@v@String categories[])
{
    (void)c; (void)on; (void)n; (void)categories;
    return fmi@v@OK;
}

2|FMI2 fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String token, fmi2String resources,
2|                                   const void *callbacks, fmi2Boolean visible, fmi2Boolean logging)
2|{
2|    model *m;
2|    (void)name; (void)type; (void)resources; (void)callbacks; (void)visible; (void)logging;
2|    if (token == NULL || strcmp(token, MODEL_TOKEN) != 0) {
2|        return NULL;
2|    }
2|    m = (model *)calloc(1, sizeof *m);
2|    if (m != NULL) {
2|        model_reset(m);
2|    }
2|    return m;
2|}
2|
3|static fmi3Instance instantiate(fmi3String token)
3|{
3|    model *m;
3|    if (token == NULL || strcmp(token, MODEL_TOKEN) != 0) {
3|        return NULL;
3|    }
3|    m = (model *)calloc(1, sizeof *m);
3|    if (m != NULL) {
3|        model_reset(m);
3|    }
3|    return m;
3|}
3|
3|FMI3 fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
3|                                               fmi3Boolean logging, fmi3InstanceEnvironment environment,
3|                                               fmi3LogMessageCallback log)
3|{
3|    (void)name; (void)resources; (void)visible; (void)logging; (void)environment; (void)log;
3|    return instantiate(token);
3|}
3|
3|FMI3 fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
3|                                              fmi3Boolean logging, fmi3Boolean event_mode, fmi3Boolean early_return,
3|                                              const fmi3ValueReference intermediate[], size_t n,
3|                                              fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
3|                                              fmi3IntermediateUpdateCallback update)
3|{
3|    (void)name; (void)resources; (void)visible; (void)logging; (void)event_mode; (void)early_return; (void)intermediate;
3|    (void)n; (void)environment; (void)log; (void)update;
3|    return instantiate(token);
3|}
3|
3|FMI3 fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
3|                                                    fmi3Boolean visible, fmi3Boolean logging,
3|                                                    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
3|                                                    fmi3ClockUpdateCallback clock, fmi3LockPreemptionCallback lock,
3|                                                    fmi3LockPreemptionCallback unlock)
3|{
3|    (void)name; (void)token; (void)resources; (void)visible; (void)logging; (void)environment; (void)log; (void)clock;
3|    (void)lock; (void)unlock;
3|    return NULL;
3|}
3|
FMI@v@ void fmi@v@FreeInstance(@instance@ c)
{
    free(c);
}

2|FMI2 fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, double tolerance, double start,
2|                                    fmi2Boolean has_stop, double stop)
2|{
2|    (void)has_tolerance; (void)tolerance; (void)has_stop; (void)stop;
2|    ((model *)c)->time = start;
2|    return fmi2OK;
2|}
2|
3|FMI3 fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean has_tolerance, double tolerance, double start,
3|                                            fmi3Boolean has_stop, double stop)
3|{
3|    (void)has_tolerance; (void)tolerance; (void)has_stop; (void)stop;
3|    ((model *)c)->time = start;
3|    return fmi3OK;
3|}
3|
3|FMI3 fmi3Status fmi3ExitInitializationMode(fmi3Instance c)
3|{
3|    model_count_periods((model *)c);
3|    return fmi3OK;
3|}
3|
#define NOTHING(name) \
    FMI@v@ fmi@v@Status name(@instance@ c) \
    { \
        (void)c; \
        return fmi@v@OK; \
    }
2|NOTHING(fmi2EnterInitializationMode)
3|NOTHING(fmi3EnterEventMode)
NOTHING(fmi@v@Terminate)
2|NOTHING(fmi2EnterEventMode)
3|NOTHING(fmi3EnterConfigurationMode)
3|NOTHING(fmi3ExitConfigurationMode)
3|NOTHING(fmi3EvaluateDiscreteStates)
NOTHING(fmi@v@EnterContinuousTimeMode)
3|NOTHING(fmi3EnterStepMode)

2|FMI2 fmi2Status fmi2ExitInitializationMode(fmi2Component c)
2|{
2|    model_count_periods((model *)c);
2|    return fmi2OK;
2|}
2|
FMI@v@ fmi@v@Status fmi@v@Reset(@instance@ c)
{
    model_reset((model *)c);
    return fmi@v@OK;
}

2|FMI2 fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, double values[])
3|FMI3 fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, double values[], size_t nv)
{
    size_t i;
3|    if (n != nv) {
3|        return fmi3Error;
3|    }
    for (i = 0; i < n; i++) {
        if (!model_get((model *)c, vr[i], &values[i])) {
            return fmi@v@Error;
        }
    }
    return fmi@v@OK;
}

2|FMI2 fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const double values[])
3|FMI3 fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const double values[], size_t nv)
{
    size_t i;
3|    if (n != nv) {
3|        return fmi3Error;
3|    }
    for (i = 0; i < n; i++) {
        if (!model_set((model *)c, vr[i], values[i])) {
            return fmi@v@Error;
        }
    }
    return fmi@v@OK;
}

2|FMI2 fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Integer values[])
2|{
2|    size_t i;
2|    for (i = 0; i < n; i++) {
2|        if (vr[i] != MODEL_PERIODS_REFERENCE) {
2|            return fmi2Error;
2|        }
2|        values[i] = ((model *)c)->periods;
2|    }
2|    return fmi2OK;
2|}
2|
3|FMI3 fmi3Status fmi3GetInt32(fmi3Instance c, const fmi3ValueReference vr[], size_t n, int32_t values[], size_t nv)
3|{
3|    size_t i;
3|    if (n != nv) {
3|        return fmi3Error;
3|    }
3|    for (i = 0; i < n; i++) {
3|        if (vr[i] != MODEL_PERIODS_REFERENCE) {
3|            return fmi3Error;
3|        }
3|        values[i] = ((model *)c)->periods;
3|    }
3|    return fmi3OK;
3|}
3|
2|/* The model has no variables of these types. */
2|#define NO_VARIABLES(name, type) \
2|    FMI2 fmi2Status name(fmi2Component c, const fmi2ValueReference vr[], size_t n, type values[]) \
2|    { \
2|        (void)c; (void)vr; (void)values; \
2|        return status_of(n == 0); \
2|    }
2|NO_VARIABLES(fmi2GetBoolean, fmi2Boolean)
2|NO_VARIABLES(fmi2GetString, fmi2String)
2|NO_VARIABLES(fmi2SetInteger, const fmi2Integer)
2|NO_VARIABLES(fmi2SetBoolean, const fmi2Boolean)
2|NO_VARIABLES(fmi2SetString, const fmi2String)
2|
3|/* The model has no variables of these types. */
3|#define NO_VARIABLES(name, type) \
3|    FMI3 fmi3Status fmi3Get##name(fmi3Instance c, const fmi3ValueReference vr[], size_t n, type values[], size_t nv) \
3|    { \
3|        (void)c; (void)vr; (void)values; (void)nv; \
3|        return status_of(n == 0); \
3|    } \
3|    NO_INPUTS(name, type)
3|#define NO_INPUTS(name, type) \
3|    FMI3 fmi3Status fmi3Set##name(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const type values[], size_t nv) \
3|    { \
3|        (void)c; (void)vr; (void)values; (void)nv; \
3|        return status_of(n == 0); \
3|    }
3|NO_VARIABLES(Float32, float)
3|NO_VARIABLES(Int8, int8_t)
3|NO_VARIABLES(UInt8, uint8_t)
3|NO_VARIABLES(Int16, int16_t)
3|NO_VARIABLES(UInt16, uint16_t)
3|NO_INPUTS(Int32, int32_t)
3|NO_VARIABLES(UInt32, uint32_t)
3|NO_VARIABLES(Int64, int64_t)
3|NO_VARIABLES(UInt64, uint64_t)
3|NO_VARIABLES(Boolean, bool)
3|NO_VARIABLES(String, fmi3String)
3|
3|FMI3 fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t n, size_t sizes[], fmi3Binary values[],
3|                              size_t nv)
3|{
3|    (void)c; (void)vr; (void)sizes; (void)values; (void)nv;
3|    return status_of(n == 0);
3|}
3|
3|FMI3 fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const size_t sizes[],
3|                              const fmi3Binary values[], size_t nv)
3|{
3|    (void)c; (void)vr; (void)sizes; (void)values; (void)nv;
3|    return status_of(n == 0);
3|}
3|
3|FMI3 fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Clock values[])
3|{
3|    (void)c; (void)vr; (void)values;
3|    return status_of(n == 0);
3|}
3|
3|FMI3 fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Clock values[])
3|{
3|    (void)c; (void)vr; (void)values;
3|    return status_of(n == 0);
3|}
3|
3|FMI3 fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance c, fmi3ValueReference vr, size_t *n)
3|{
3|    (void)c; (void)vr; (void)n;
3|    return fmi3Error;
3|}
3|
3|FMI3 fmi3Status fmi3GetVariableDependencies(fmi3Instance c, fmi3ValueReference dependent, size_t element[],
3|                                            fmi3ValueReference independents[], size_t independent_element[],
3|                                            fmi3DependencyKind kinds[], size_t n)
3|{
3|    (void)c; (void)dependent; (void)element; (void)independents; (void)independent_element; (void)kinds; (void)n;
3|    return fmi3Error;
3|}
3|
FMI@v@ fmi@v@Status fmi@v@Get@state@(@instance@ c, fmi@v@@state@ *state)
{
    if (*state == NULL) {
        *state = malloc(sizeof(model));
    }
    if (*state == NULL) {
        return fmi@v@Error;
    }
    memcpy(*state, c, sizeof(model));
    return fmi@v@OK;
}

FMI@v@ fmi@v@Status fmi@v@Set@state@(@instance@ c, fmi@v@@state@ state)
{
    memcpy(c, state, sizeof(model));
    return fmi@v@OK;
}

FMI@v@ fmi@v@Status fmi@v@Free@state@(@instance@ c, fmi@v@@state@ *state)
{
    (void)c;
    free(*state);
    *state = NULL;
    return fmi@v@OK;
}

FMI@v@ fmi@v@Status fmi@v@Serialized@state@Size(@instance@ c, fmi@v@@state@ state, size_t *size)
{
    (void)c; (void)state;
    *size = sizeof(model);
    return fmi@v@OK;
}

FMI@v@ fmi@v@Status fmi@v@Serialize@state@(@instance@ c, fmi@v@@state@ state, @byte@ bytes[], size_t size)
{
    (void)c;
    if (size != sizeof(model)) {
        return fmi@v@Error;
    }
    memcpy(bytes, state, size);
    return fmi@v@OK;
}

2|FMI2 fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
3|FMI3 fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const uint8_t bytes[], size_t size, fmi3FMUState *state)
{
    (void)c;
    if (size != sizeof(model)) {
        return fmi@v@Error;
    }
    if (*state == NULL) {
        *state = malloc(size);
    }
    if (*state == NULL) {
        return fmi@v@Error;
    }
    memcpy(*state, bytes, size);
    return fmi@v@OK;
}

FMI@v@ fmi@v@Status fmi@v@GetDirectionalDerivative(@instance@ c, const fmi@v@ValueReference unknowns[], size_t n,
                                             const fmi@v@ValueReference knowns[], size_t n_knowns, const double seed[],
2|                                             double sensitivity[])
3|                                             size_t n_seed, double sensitivity[], size_t n_sensitivity)
{
3|    if (n_knowns != n_seed || n != n_sensitivity) {
3|        return fmi3Error;
3|    }
    return status_of(model_directional((const model *)c, unknowns, n, knowns, n_knowns, seed, sensitivity));
}

3|FMI3 fmi3Status fmi3GetAdjointDerivative(fmi3Instance c, const fmi3ValueReference unknowns[], size_t n,
3|                                         const fmi3ValueReference knowns[], size_t n_knowns, const double seed[],
3|                                         size_t n_seed, double sensitivity[], size_t n_sensitivity)
3|{
3|    (void)c; (void)unknowns; (void)n; (void)knowns; (void)n_knowns; (void)seed; (void)n_seed; (void)sensitivity;
3|    (void)n_sensitivity;
3|    return fmi3Error;
3|}
3|
3|FMI3 fmi3Status fmi3GetIntervalDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t n, double intervals[],
3|                                       fmi3IntervalQualifier qualifiers[])
3|{
3|    (void)c; (void)vr; (void)n; (void)intervals; (void)qualifiers;
3|    return fmi3Error;
3|}
3|
3|FMI3 fmi3Status fmi3GetIntervalFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t n, uint64_t counters[],
3|                                        uint64_t resolutions[], fmi3IntervalQualifier qualifiers[])
3|{
3|    (void)c; (void)vr; (void)n; (void)counters; (void)resolutions; (void)qualifiers;
3|    return fmi3Error;
3|}
3|
3|FMI3 fmi3Status fmi3GetShiftDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t n, double shifts[])
3|{
3|    (void)c; (void)vr; (void)n; (void)shifts;
3|    return fmi3Error;
3|}
3|
3|FMI3 fmi3Status fmi3GetShiftFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t n, uint64_t counters[],
3|                                     uint64_t resolutions[])
3|{
3|    (void)c; (void)vr; (void)n; (void)counters; (void)resolutions;
3|    return fmi3Error;
3|}
3|
3|FMI3 fmi3Status fmi3SetIntervalDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const double intervals[])
3|{
3|    (void)c; (void)vr; (void)n; (void)intervals;
3|    return fmi3Error;
3|}
3|
3|FMI3 fmi3Status fmi3SetIntervalFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const uint64_t counters[],
3|                                        const uint64_t resolutions[])
3|{
3|    (void)c; (void)vr; (void)n; (void)counters; (void)resolutions;
3|    return fmi3Error;
3|}
3|
3|FMI3 fmi3Status fmi3SetShiftDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const double shifts[])
3|{
3|    (void)c; (void)vr; (void)n; (void)shifts;
3|    return fmi3Error;
3|}
3|
3|FMI3 fmi3Status fmi3SetShiftFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const uint64_t counters[],
3|                                     const uint64_t resolutions[])
3|{
3|    (void)c; (void)vr; (void)n; (void)counters; (void)resolutions;
3|    return fmi3Error;
3|}
3|
2|FMI2 fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info)
3|FMI3 fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *again, fmi3Boolean *terminate, fmi3Boolean *nominals,
3|                                         fmi3Boolean *values, fmi3Boolean *next_defined, double *next)
{
    model_count_periods((model *)c);
2|    memset(info, 0, sizeof *info);
3|    *again = *terminate = *nominals = *values = *next_defined = false;
3|    *next = 0;
    return fmi@v@OK;
}

FMI@v@ fmi@v@Status fmi@v@CompletedIntegratorStep(@instance@ c, fmi@v@Boolean no_rollback, fmi@v@Boolean *enter_event_mode,
                                            fmi@v@Boolean *terminate)
{
    (void)c; (void)no_rollback;
2|    *enter_event_mode = *terminate = 0;
3|    *enter_event_mode = *terminate = false;
    return fmi@v@OK;
}

FMI@v@ fmi@v@Status fmi@v@SetTime(@instance@ c, double time)
{
    ((model *)c)->time = time;
    return fmi@v@OK;
}

FMI@v@ fmi@v@Status fmi@v@SetContinuousStates(@instance@ c, const double x[], size_t n)
{
    if (n != MODEL_STATES) {
        return fmi@v@Error;
    }
    model_set_states((model *)c, x);
    return fmi@v@OK;
}

2|FMI2 fmi2Status fmi2GetDerivatives(fmi2Component c, double rates[], size_t n)
3|FMI3 fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, double rates[], size_t n)
{
    return status_of(n == MODEL_STATES && model_rates((const model *)c, rates));
}

FMI@v@ fmi@v@Status fmi@v@GetEventIndicators(@instance@ c, double indicators[], size_t n)
{
    if (n != MODEL_INDICATORS) {
        return fmi@v@Error;
    }
    model_indicators((const model *)c, indicators);
    return fmi@v@OK;
}

FMI@v@ fmi@v@Status fmi@v@GetContinuousStates(@instance@ c, double x[], size_t n)
{
    if (n != MODEL_STATES) {
        return fmi@v@Error;
    }
    model_states((const model *)c, x);
    return fmi@v@OK;
}

FMI@v@ fmi@v@Status fmi@v@GetNominalsOfContinuousStates(@instance@ c, double nominals[], size_t n)
{
    size_t i;
    (void)c;
    for (i = 0; i < n; i++) {
        nominals[i] = 1;
    }
    return status_of(n == MODEL_STATES);
}

2|FMI2 fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
2|                                            const fmi2Integer orders[], const double values[])
2|{
2|    (void)c; (void)vr; (void)n; (void)orders; (void)values;
2|    return fmi2Error;
2|}
2|
2|FMI2 fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
2|                                             const fmi2Integer orders[], double values[])
2|{
2|    (void)c; (void)vr; (void)n; (void)orders; (void)values;
2|    return fmi2Error;
2|}
2|
3|FMI3 fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *n)
3|{
3|    (void)c;
3|    *n = MODEL_INDICATORS;
3|    return fmi3OK;
3|}
3|
3|FMI3 fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *n)
3|{
3|    (void)c;
3|    *n = MODEL_STATES;
3|    return fmi3OK;
3|}
3|
3|FMI3 fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const int32_t orders[],
3|                                         double values[], size_t nv)
3|{
3|    (void)c; (void)vr; (void)n; (void)orders; (void)values; (void)nv;
3|    return fmi3Error;
3|}
3|
2|FMI2 fmi2Status fmi2DoStep(fmi2Component c, double time, double step, fmi2Boolean no_rollback)
2|{
2|    (void)no_rollback;
2|    return status_of(model_advance((model *)c, time, step));
2|}
2|
3|FMI3 fmi3Status fmi3DoStep(fmi3Instance c, double time, double step, fmi3Boolean no_rollback, fmi3Boolean *event,
3|                           fmi3Boolean *terminate, fmi3Boolean *early_return, double *last)
3|{
3|    const int ok = model_advance((model *)c, time, step);
3|    (void)no_rollback;
3|    *event = *terminate = *early_return = false;
3|    *last = ((model *)c)->time;
3|    return status_of(ok);
3|}
3|
2|FMI2 fmi2Status fmi2CancelStep(fmi2Component c)
2|{
2|    (void)c;
2|    return fmi2Error;
2|}
2|
2|FMI2 fmi2Status fmi2GetStatus(fmi2Component c, fmi2StatusKind kind, fmi2Status *value)
2|{
2|    (void)c; (void)kind; (void)value;
2|    return fmi2Discard;
2|}
2|
2|FMI2 fmi2Status fmi2GetRealStatus(fmi2Component c, fmi2StatusKind kind, double *value)
2|{
2|    (void)c; (void)kind; (void)value;
2|    return fmi2Discard;
2|}
2|
2|FMI2 fmi2Status fmi2GetIntegerStatus(fmi2Component c, fmi2StatusKind kind, fmi2Integer *value)
2|{
2|    (void)c; (void)kind; (void)value;
2|    return fmi2Discard;
2|}
2|
2|FMI2 fmi2Status fmi2GetBooleanStatus(fmi2Component c, fmi2StatusKind kind, fmi2Boolean *value)
2|{
2|    (void)c; (void)kind; (void)value;
2|    return fmi2Discard;
2|}
2|
2|FMI2 fmi2Status fmi2GetStringStatus(fmi2Component c, fmi2StatusKind kind, fmi2String *value)
2|{
2|    (void)c; (void)kind; (void)value;
2|    return fmi2Discard;
2|}
3|FMI3 fmi3Status fmi3ActivateModelPartition(fmi3Instance c, fmi3ValueReference clock, double time)
3|{
3|    (void)c; (void)clock; (void)time;
3|    return fmi3Error;
3|}
