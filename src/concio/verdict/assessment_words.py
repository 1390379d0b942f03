"""Words of the verdict on a seismic assessment, by language; both languages have the same keys and places."""

from __future__ import annotations

from collections.abc import Mapping

EN = {
    "asked": "every local mechanism at {levels}, {code}, FC {FC}: the earthquake multiplies the horizontal loads, all "
    "other loads are constant",
    "headline_holds": "Verified: zeta_E = {zeta} at {level}",
    "headline_fails": "Not verified: zeta_E = {zeta} at {level}",
    "headline_incomplete": "Incomplete: zeta_E = {zeta} at {level} of what was checked",
    "headline_unchecked": "Incomplete: zeta_E at {level} was not checked",
    "headline_none": "Verified: no mechanism that an earthquake could set in motion",
    "headline_none_incomplete": "Incomplete: no mechanism was found, and something was not checked",
    "answer": "The least zeta_E at {level} is {zeta}, of '{name}', push {way}, alpha_0 {alpha}.",
    "answer_unchecked": "zeta_E at {level} was not checked of '{name}', push {way}, alpha_0 {alpha}, or of any other.",
    "not_checked": "not checked",
    "by_level": "Least of all mechanisms by limit state: {levels}.",
    "rest": "{level} {zeta}",
    "answer_none": "No mechanism was found that an earthquake could set in motion: {why}.",
    "fails": "That is less than 1.",
    "fails_other": "At {level} it is {zeta}, less than 1.",
    "holds": "All limit states asked for are met.",
    "incomplete": "Nothing that was checked fails, but not everything was checked: this is not a verification.",
    "none": "'{name}', push {way}: {why}",
    "locked": "locked: friction and geometry carry any push, so that no mechanism forms",
    "large": "no mechanism below {largest} g: the least multiplier is {alpha}",
    "proof_none": "The limit programmes were recomputed from the assembly.",
    "proof_no_sliding": "alpha_0 of '{name}' is proved from both sides over all motions of the blocks that may "
    "move: forces in equilibrium and a motion, recomputed from the assembly, with a duality gap of {gap}; no rough "
    "joint slides.",
    "proof_Coulomb": "alpha_0 of '{name}' is that of a collapse state of Coulomb friction, with equilibrium, "
    "friction and flow recomputed from the assembly. What is proved beside it is an upper bound: no collapse under "
    "push {way} lies above {upper} (associated limit over all motions, duality gap {gap}). That nothing begins to "
    "move below alpha_0 is not proved: no load was carried up to it in steps.",
    "proof_Coulomb_part": "alpha_0 of '{name}' is that of a collapse state of Coulomb friction in which the other "
    "blocks stand, with equilibrium, friction and flow recomputed from the assembly. What is proved beside it is an "
    "upper bound: no such collapse of these blocks under push {way} lies above {upper} (associated limit of their "
    "motions, duality gap {gap}). That nothing begins to move below alpha_0 is not proved: no load was carried up to "
    "it in steps.",
    "proof_associated": "alpha_0 of '{name}' is an upper bound only: the associated limit, with a duality gap of "
    "{gap}; no collapse state of Coulomb friction was found.",
    "sought": "searches made: {sought}, of which {named} of named mechanisms and {parts} in other parts of the "
    "structure: above levels at which blocks meet ({levels}), beside lines of openings ({openings}), at faces of "
    "returns and cross walls ({returns}), beyond other lines at which it changes ({changes}), where places that part "
    "the same blocks from the rest need one search; followed: {followed}; "
    "the others begin to move only at accelerations beyond those of these",
    "left_out": "sought at {sought} of {there} {what}: the structure is too large for all; name parts of it to seek "
    "more",
    "what_levels": "levels",
    "what_openings": "lines of openings",
    "what_returns": "faces of returns",
    "what_changes": "other lines",
    "part": "the weakest of all is one in which only some blocks move, {bodies}; the search among all motions ended "
    "at a larger multiplier",
    "part_decides": "the mechanism that decides, '{name}', is one in which only some blocks move, {bodies}; all "
    "motions were searched as well",
    "alike": "other blocks slide at the same alpha_0 as '{name}', with another zeta_E: parts of many shapes do, and "
    "which of them a search meets depends on the order of the blocks in the file; name the parts that matter",
    "least_alike": "other blocks slide at the same alpha_0 as '{name}', with another zeta_E: each block with what lies "
    "on it and what stands in its way was followed, and the least zeta_E is reported; further parts that slide are not "
    "excluded",
    "brittle": "tie '{tie}' breaks before it yields: its force at break, {force} kN, is used instead of its yield "
    "force",
    "tie_limit": "'{name}', {level}: its limit of displacement is where ties have broken and alpha is below half "
    "of its largest, as the code asks; with ties that break later, or without them, zeta_E may be larger",
    "corner": "'{name}', {level}: zeta_E = {zeta} is a ratio of accelerations, capacity over demand in "
    "displacements is {ratio}: as a_g is scaled the corner periods move with it, so that the displacement demanded "
    "does not grow like a_g",
    "corner_one": "; the same is true of one other value of zeta_E",
    "corner_more": "; the same is true of {n} other values of zeta_E",
    "cut": "the curve of '{name}', push {way}, is cut at {d} m of its control point: {reason}; its zeta_E ignores what "
    "lies beyond",
    "strips": "out of its plane the facade was searched in {n} strips, cut from the drawing and free at their sides "
    "(returns, cross walls and the bond beside them are not counted), cracking at {courses} courses at most; {held}",
    "strips_free": "no height was given at which floors or ties hold it, so that none was counted",
    "strips_held": "held in both senses at {heights} m, as given: that floors and ties can hold it is not checked",
    "elsewhere": "left to the author, who answers for it: {items}",
    "elsewhere_out of plane": "the facade out of its plane",
    "elsewhere_height": "amplification at height",
    "elsewhere_ties": "ties without yield force",
    "building_tall": "[site.building] has a height of {height} m, more than any masonry building: is it in m? The "
    "taller the building, the less is amplified at a height",
    "building_low": "[site.building] ends at {top} m, and mechanisms start above it, up to z = {z} m: is its height "
    "that of the whole building, in m?",
    "open_levels": "{levels}: no hazard is given (or say which limit states are asked for)",
    "open_hazard": "{numbers} of {level} were not given: the spectrum uses default values that belong to no site",
    "open_height": "the amplification at height of {names}: give [site.building]",
    "open_out of plane": "the facade out of its plane: the model is wider than it is thick, and moves in its plane "
    "alone",
    "open_out of plane, live": "the facade out of its plane: 'live' names the loads that are multiplied, and they act "
    "in its plane; without 'live' it is searched out of its plane too",
    "open_curve": "'{name}', push {way}, at {levels}: its curve is not conclusive ({reason})",
    "open_strips": "{n} mechanisms of strips out of the plane, at {levels}, the first of them '{name}', push {way}, "
    "with alpha_0 {alpha}: their curve is not conclusive ({reason})",
    "open_bound": "whether '{name}', push {way}, begins to move below {alpha}, which is an upper bound only",
    "open_hand": "'{name}', push {way}: by virtual work, computed once more from the coordinates, alpha_0 is {hand} "
    "and not {alpha}",
    "open_tie": "tie '{tie}', which has no yield force: it was taken to pull with up to {force} kN",
    "open_unseen": "whether anything holds {names}: the loads there are less than {share} of those of the structure "
    "around, below the resolution of the residuals",
    "open_locked": "'{name}', push {way}: with joints that open as they slide it is locked, with Coulomb friction "
    "that is no answer, and no collapse state was found",
    "ground_hand": "alpha_0 of '{name}' by virtual work, block by block from the coordinates of the model, is {hand}; "
    "the program has {alpha} (difference {difference})",
    "ground_all": "the same was done for all {n} mechanisms that are reported; largest difference {difference}",
    "ground_differs": "for {n} of the mechanisms that are reported the check by hand and the program differ by up to "
    "{difference}: the results are not to be accepted before that is understood",
    "ground_bound": "forces in equilibrium and a motion prove the least multiplier of push {way} over all motions "
    "with associated friction, {alpha}, with a duality gap of {gap}; with Coulomb friction the least is not above it",
    "ground_open": "things that were asked for or are to be expected and were not checked: {n}; they are listed below",
    "note_period": "the hazard given for {level} is that of a return period of {given} years; the code asks for {own}",
    "note_strong": "a_g = {a_g} g on rock at {level} is more than any site in Italy has; check that g was meant",
    "note_confidence": "the confidence factor of {given} was given by the author; that of {level} would be {own}",
    "note_q": "the behaviour factor q of {given} was given by the author; that of the code is {own}",
    "note_participation": "the share of the mass that takes part, e* = {given}, was given by the author; that of a "
    "mechanism is {own}",
    "note_idle": "{what} of {level} do not count: {code} fixes the spectrum by type and soil",
    "assumed": "not given, and assumed: {what}",
    "assumed_soil": "soil {value}",
    "assumed_topography": "topography {value}",
    "assumed_nominal_life": "nominal life {value} years",
    "assumed_use_class": "class of use {value}",
    "high": "'{name}' (z = {z} m)",
    "and_more": "{n} more",
    "row_holds": "verified, {ratio}",
    "row_fails": "not verified, {ratio}",
    "row_rest": "verified: it does not begin to move below a_g = {least} g",
    "row_beside": "{word} (the check in displacements decides)",
    "meaning": "Of the mechanisms that the model can show; what is not in the model cannot fail in it.",
}

IT = {
    "asked": "ogni meccanismo locale allo {levels}, {code}, FC {FC}: il sisma moltiplica i carichi orizzontali, tutti "
    "gli altri sono costanti",
    "headline_holds": "Verificato: zeta_E = {zeta} allo {level}",
    "headline_fails": "Non verificato: zeta_E = {zeta} allo {level}",
    "headline_incomplete": "Incompleto: zeta_E = {zeta} allo {level} per ciò che è stato esaminato",
    "headline_unchecked": "Incompleto: zeta_E allo {level} non è stato esaminato",
    "headline_none": "Verificato: nessun meccanismo che il sisma possa attivare",
    "headline_none_incomplete": "Incompleto: nessun meccanismo trovato, e qualcosa non è stato esaminato",
    "answer": "Il minimo zeta_E allo {level} è {zeta}, di «{name}», spinta {way}, alpha_0 {alpha}.",
    "answer_unchecked": "zeta_E allo {level} non è stato esaminato per «{name}», spinta {way}, alpha_0 {alpha}, né per "
    "altri.",
    "not_checked": "non esaminato",
    "by_level": "Minimo fra tutti i meccanismi per stato limite: {levels}.",
    "rest": "{level} {zeta}",
    "answer_none": "Non è stato trovato alcun meccanismo che il sisma possa attivare: {why}.",
    "fails": "È minore di 1.",
    "fails_other": "Allo {level} è {zeta}, minore di 1.",
    "holds": "Tutti gli stati limite richiesti sono soddisfatti.",
    "incomplete": "Nulla di ciò che è stato esaminato è insufficiente, ma non tutto è stato esaminato: non è una "
    "verifica.",
    "none": "«{name}», spinta {way}: {why}",
    "locked": "bloccato: attrito e geometria portano qualunque spinta, non si forma alcun meccanismo",
    "large": "nessun meccanismo sotto {largest} g: il moltiplicatore minimo è {alpha}",
    "proof_none": "I programmi di analisi limite sono ricalcolati dal modello assemblato.",
    "proof_no_sliding": "alpha_0 di «{name}» è dimostrato dai due lati fra tutti i moti dei blocchi che possono "
    "muoversi: forze in equilibrio e un moto, ricalcolati dal modello assemblato, con uno scarto di dualità di "
    "{gap}; nessun giunto con attrito scorre.",
    "proof_Coulomb": "alpha_0 di «{name}» è quello di uno stato di collasso con attrito di Coulomb, con equilibrio, "
    "attrito e flusso ricalcolati dal modello assemblato. Dimostrato accanto è un limite superiore: nessun collasso "
    "con spinta {way} sta sopra {upper} (limite associato fra tutti i moti, scarto di dualità {gap}). Che nulla si "
    "muova sotto alpha_0 non è dimostrato: nessun carico è stato fatto crescere a passi fino a esso.",
    "proof_Coulomb_part": "alpha_0 di «{name}» è quello di uno stato di collasso con attrito di Coulomb in cui gli "
    "altri blocchi restano fermi, con equilibrio, attrito e flusso ricalcolati dal modello assemblato. Dimostrato "
    "accanto è un limite superiore: nessun collasso di questi blocchi con spinta {way} sta sopra {upper} (limite "
    "associato dei loro moti, scarto di dualità {gap}). Che nulla si muova sotto alpha_0 non è dimostrato: nessun "
    "carico è stato fatto crescere a passi fino a esso.",
    "proof_associated": "alpha_0 di «{name}» è solo un limite superiore: quello associato, con uno scarto di "
    "dualità di {gap}; non è stato trovato alcuno stato di collasso con attrito di Coulomb.",
    "sought": "ricerche fatte: {sought}, di cui {named} di meccanismi con nome e {parts} in altre parti della "
    "struttura: sopra le quote in cui i blocchi si incontrano ({levels}), accanto alle linee delle aperture "
    "({openings}), alle facce di risvolti e muri di spina ({returns}), oltre altre linee in cui la struttura cambia "
    "({changes}), con una sola ricerca per i punti che separano gli stessi blocchi dal resto; {followed} meccanismi "
    "sono stati seguiti, gli altri si muovono solo ad accelerazioni oltre le loro",
    "left_out": "cercato in {sought} di {there} {what}: la struttura è troppo grande per tutte; per cercare altrove "
    "nominarne le parti",
    "what_levels": "quote",
    "what_openings": "linee di aperture",
    "what_returns": "facce di risvolti",
    "what_changes": "altre linee",
    "part": "il più debole di tutti è uno in cui si muovono solo alcuni blocchi, {bodies}; la ricerca fra tutti i "
    "moti finiva a un moltiplicatore maggiore",
    "part_decides": "il meccanismo che decide, «{name}», è uno in cui si muovono solo alcuni blocchi, {bodies}; anche "
    "tutti i moti sono stati esaminati",
    "alike": "altri blocchi scorrono allo stesso alpha_0 di «{name}», con un altro zeta_E: lo fanno parti di molte "
    "forme, e quale di esse una ricerca incontra dipende dall'ordine dei blocchi nel file; indicare "
    "le parti che contano",
    "least_alike": "altri blocchi scorrono allo stesso alpha_0 di «{name}», con un altro zeta_E: ogni blocco con ciò "
    "che vi poggia e ciò che gli sta davanti è stato seguito, e si dà il minimo zeta_E; altre parti che scorrono non "
    "sono escluse",
    "brittle": "la catena «{tie}» si rompe prima di snervarsi: si considera la forza alla rottura, {force} kN, non "
    "quella di snervamento",
    "tie_limit": "«{name}», {level}: il limite di spostamento è quello in cui le catene sono rotte e alpha è sotto la "
    "metà del suo massimo, come chiede la norma; con catene che si rompono più tardi, o senza, zeta_E può essere "
    "maggiore",
    "corner": "«{name}», {level}: zeta_E = {zeta} è un rapporto di accelerazioni, capacità su domanda in "
    "spostamento vale {ratio}: scalando a_g si spostano i periodi dello spettro, e lo spostamento richiesto non "
    "cresce come a_g",
    "corner_one": "; lo stesso vale per un altro valore di zeta_E",
    "corner_more": "; lo stesso vale per altri {n} valori di zeta_E",
    "cut": "la curva di «{name}», spinta {way}, è troncata a {d} m del punto di controllo: {reason}; il suo zeta_E "
    "trascura quanto segue",
    "strips": "fuori dal piano la facciata è stata esaminata in {n} strisce, tagliate dal disegno e libere ai lati "
    "(risvolti, muri di spina e ammorsature non sono considerati), con fessure in corrispondenza di al più {courses} "
    "corsi; {held}",
    "strips_free": "non è stata indicata alcuna quota in cui solai o catene la trattengano: nessuna è considerata",
    "strips_held": "trattenuta nei due versi alle quote {heights} m, come indicato: che solai e catene possano farlo "
    "non è verificato",
    "elsewhere": "lasciato all'autore, che ne risponde: {items}",
    "elsewhere_out of plane": "la facciata fuori dal suo piano",
    "elsewhere_height": "l'amplificazione in quota",
    "elsewhere_ties": "le catene senza forza di snervamento",
    "building_tall": "[site.building] ha un'altezza di {height} m, più di ogni edificio in muratura: è in m? Più "
    "alto è l'edificio, meno si amplifica a una quota",
    "building_low": "[site.building] finisce a {top} m, e alcuni meccanismi partono più in alto, fino a z = {z} m: la "
    "sua altezza è quella di tutto l'edificio, in m?",
    "open_levels": "{levels}: pericolosità non data (oppure indicare quali stati limite sono richiesti)",
    "open_hazard": "{numbers} dello {level} non dati: lo spettro usa valori predefiniti, non riferiti a un sito",
    "open_height": "l'amplificazione in quota di {names}: indicare [site.building]",
    "open_out of plane": "la facciata fuori dal suo piano: il modello è più largo che spesso, e si muove solo nel "
    "piano",
    "open_out of plane, live": "la facciata fuori dal suo piano: «live» nomina i carichi moltiplicati, che agiscono "
    "nel suo piano; senza «live» è cercata anche fuori dal piano",
    "open_curve": "«{name}», spinta {way}, allo {levels}: la curva non è conclusiva ({reason})",
    "open_strips": "{n} meccanismi di strisce fuori dal piano, allo {levels}, il primo «{name}», spinta {way}, con "
    "alpha_0 {alpha}: la loro curva non è conclusiva ({reason})",
    "open_bound": "se «{name}», spinta {way}, si muova sotto {alpha}, che è solo un limite superiore",
    "open_hand": "«{name}», spinta {way}: con i lavori virtuali, ricalcolati dalle coordinate, alpha_0 vale {hand} e "
    "non {alpha}",
    "open_tie": "la catena «{tie}», senza forza di snervamento: si è ammesso che tiri fino a {force} kN",
    "open_unseen": "se {names} stiano in equilibrio: i carichi su quei corpi sono meno di {share} di quelli della "
    "struttura intorno, sotto la risoluzione dei residui",
    "open_locked": "«{name}», spinta {way}: con giunti che si aprono scorrendo è bloccato, con l'attrito di Coulomb "
    "non è una risposta, e non è stato trovato alcuno stato di collasso",
    "ground_hand": "alpha_0 di «{name}» con i lavori virtuali, blocco per blocco dalle coordinate del modello, vale "
    "{hand}; il programma dà {alpha} (differenza {difference})",
    "ground_all": "lo stesso è stato fatto per tutti e {n} i meccanismi riportati; differenza massima {difference}",
    "ground_differs": "per {n} dei meccanismi riportati il calcolo a mano e il programma differiscono fino a "
    "{difference}: i risultati non vanno accettati prima di averne capito il motivo",
    "ground_bound": "forze in equilibrio e un moto dimostrano il moltiplicatore minimo della spinta {way} fra tutti i "
    "moti con attrito associato, {alpha}, con uno scarto di dualità di {gap}; con l'attrito di Coulomb il minimo non è "
    "maggiore",
    "ground_open": "cose richieste o da attendersi e non esaminate: {n}; sono elencate sotto",
    "note_period": "la pericolosità data per {level} è di un periodo di ritorno di {given} anni; la norma chiede {own}",
    "note_strong": "a_g = {a_g} g su roccia allo {level} supera quella di ogni sito italiano: è in g?",
    "note_confidence": "il fattore di confidenza {given} è indicato dall'autore; quello di {level} sarebbe {own}",
    "note_q": "il fattore di comportamento q = {given} è indicato dall'autore; quello della norma è {own}",
    "note_participation": "la frazione di massa partecipante e* = {given} è indicata dall'autore; quella di un "
    "meccanismo è {own}",
    "note_idle": "{what} di {level} non contano: {code} fissa lo spettro con il tipo e il sottosuolo",
    "assumed": "non dati, e assunti: {what}",
    "assumed_soil": "sottosuolo {value}",
    "assumed_topography": "categoria topografica {value}",
    "assumed_nominal_life": "vita nominale {value} anni",
    "assumed_use_class": "classe d'uso {value}",
    "high": "«{name}» (z = {z} m)",
    "and_more": "altri {n}",
    "row_holds": "verificato, {ratio}",
    "row_fails": "non verificato, {ratio}",
    "row_rest": "verificato: non si muove sotto a_g = {least} g",
    "row_beside": "{word} (decide la verifica in spostamento)",
    "meaning": "Dei meccanismi che il modello può mostrare; ciò che il modello non contiene non può cedere in esso.",
}

WORDS: Mapping[str, Mapping[str, str]] = {"en": EN, "it": IT}
