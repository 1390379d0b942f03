"""Words of the verdict on the cause of cracks, by language; both languages have the same keys and places."""

from __future__ import annotations

from collections.abc import Mapping

EN = {
    "asked": "which of {k} possible motions, up to {most} together, explain {n} measurements within their errors "
    "({confidence} % confidence)",
    "headline_one": "One cause explains the measurements: {cause}",
    "headline_rest": "The measurements need no cause: nothing has moved by more than their errors",
    "headline_several": "{count} causes explain the measurements, and these do not tell them apart",
    "headline_none": "None of the possible motions explains the measurements",
    "headline_doubt": "One measurement contradicts all others: {names}",
    "headline_loose": "One cause explains the measurements, which do not determine its size: {cause}",
    "headline_coarse": "The steps of the settlement paths are too coarse for these errors",
    "headline_forced": "A cause fits the measurements, but forces rigid blocks together: {cause}",
    "headline_lost": "No cause was found, and not every choice of motions could be computed",
    "headline_partly": "One cause explains the measurements, and not every choice of motions could be computed: "
    "{cause}",
    "one": "The measurements are explained by {cause}. Misfit {misfit}, {allowed} is allowed (degrees of freedom: "
    "{freedom}).",
    "rest": "The measurements are explained without any motion. Misfit {misfit}, {allowed} is allowed (degrees of "
    "freedom: {freedom}).",
    "several": "The measurements are explained by {count} causes alike, the simplest first: {causes}.",
    "none": "No choice of motions explains the measurements (at most {most} together). The nearest is {cause}: misfit "
    "{misfit}, {allowed} is allowed; farthest off is '{worst}', by {away} errors.",
    "none_at_all": "No choice of motions explains the measurements (at most {most} together), and none could be "
    "computed.",
    "doubt": "Without measurement '{name}', the others are explained by {cause}; it was measured as {measured}, and "
    "{predicted} is predicted ({away} standard deviations apart). {mistake}",
    "mistake_sign": "Its sign may have been mistaken.",
    "mistake_unit": "Its unit may have been mistaken: {factor} times the value fits.",
    "mistake_place": "Its place may have been mistaken: the value fits the joint {place}.",
    "mistake_unknown": "No mistake of sign, unit or place explains it.",
    "motion": "'{name}' by {motion} ({low} to {high})",
    "motion_open": "'{name}' by {motion} (not determined)",
    "nothing": "no motion",
    "and": " and ",
    "or": "; or ",
    "stands": "It stands there, at large displacements, and the motion can grow by {left} more before no equilibrium "
    "is found.",
    "stands_far": "It stands there, at large displacements, and still does at {times} times the motion.",
    "stands_not": "At large displacements no equilibrium was found beyond {share} of this motion.",
    "stands_small": "It stands there at small displacements.",
    "stands_rest": "It stands as it is.",
    "another": "Another centimetre opens the widest joint from {now} to {then}.",
    "another_fails": "With another centimetre no equilibrium is found at large displacements.",
    "next": "Measure next: {places}.",
    "place_opening": "the opening of {joint} at ({at})",
    "place_slip": "the slip of {joint} at ({at})",
    "place_level": "the level of {joint} at ({at})",
    "place_displacement": "the displacement of {joint} at ({at}) along {axis}",
    "predicted": "{place}, where the causes predict {values}",
    "spread": "{place}, predicted to within {spread}",
    "proof": "Certified: the balance of forces, gaps, friction cone and slip direction of the model in every state of "
    "the settlement path to each cause, to {worst} (relative; {allowed} is allowed). {tried} choices of motions, "
    "{runs} settlement paths.",
    "proof_large": " At large displacements the last state to {residual}.",
    "meaning": "A cause is a motion of supports, or a change of loads, after which the model is in equilibrium and "
    "shows what was measured within the errors. It is one among the candidates that were given: what is not among "
    "them was not examined.",
    "unseen": "not determined by these measurements: {motions} changes them by {change} errors in all",
    "unseen_part": "'{name}' by {motion}",
    "addition": "Less simple, but clearly better: {motions}; the misfit is then {misfit}.",
    "coarse": "with finer steps, a reading of the simplest cause changes by {change} errors: give more steps",
    "orders": "where its motions come one after the other instead of together, a reading changes by {change} errors",
    "together": "the motions are taken to have grown together, after all loads: another history may crack it otherwise",
    "sparse": "causes of more motions than {size} were not examined",
    "left": "{count} choices of motions were left after one state, which missed by over {far} times what is allowed",
    "left_one": "one choice of motions was left after one state, which missed by over {far} times what is allowed",
    "lent": "hard joints between rigid blocks were given a compliance of {size} m/kN: without it their forces are not "
    "determined",
    "forced": "blocks that cannot yield are forced together: joints close by up to {closing}, {change} errors, by the "
    "compliance that they were given, and the answer belongs to that compliance",
    "local": "every choice is fitted from a few starts: a cause far from all of them may have been missed",
    "rivals": "a simpler cause would explain all but '{name}': {cause}. {mistake}",
    "small": "displacements are taken to be small in the settlement paths from which the causes are found",
    "unchecked_lost": "{count} choices of motions, which could not be followed to any fit",
    "unchecked_lost_one": "one choice of motions, which could not be followed to any fit",
    "unchecked_large": "whether it stands at large displacements",
    "unchecked_began": "whether it stands at large displacements: no equilibrium was found there even before anything "
    "moved",
    "unchecked_tests": "whether this cause is wrong: there are only as many measurements as motions",
    "step_measure": "Measure where the causes differ most, and diagnose again.",
    "step_doubt": "Measure what is in doubt again.",
    "step_candidates": "Look for what else may have moved or changed, and add it to the candidates.",
    "step_forced": "Give the joints a stiffness, or the blocks one, or bound the motions by low and high.",
    "step_watch": "Watch the widest crack: a cause that is over does not grow.",
    "number": "a change of {value} of its factor",
    "unlimited": "unlimited",
}
IT = {
    "asked": "quali di {k} movimenti possibili, fino a {most} insieme, spiegano {n} misure entro i loro errori "
    "(confidenza {confidence} %)",
    "headline_one": "Una sola causa spiega le misure: {cause}",
    "headline_rest": "Le misure non richiedono una causa: nulla si è mosso oltre i loro errori",
    "headline_several": "{count} cause spiegano le misure, che non bastano a distinguerle",
    "headline_none": "Nessuno dei movimenti possibili spiega le misure",
    "headline_doubt": "Una misura contraddice tutte le altre: {names}",
    "headline_loose": "Una sola causa spiega le misure, che non ne danno l'entità: {cause}",
    "headline_coarse": "I passi dei percorsi di cedimento sono troppo grandi per questi errori",
    "headline_forced": "Una causa è compatibile con le misure, ma comprime tra loro conci rigidi: {cause}",
    "headline_lost": "Nessuna causa trovata, e non tutte le scelte di movimenti sono state calcolate",
    "headline_partly": "Una causa spiega le misure, e non tutte le scelte di movimenti sono state calcolate: {cause}",
    "one": "Le misure sono spiegate da {cause}. Scarto {misfit}, ammesso {allowed} (gradi di libertà: {freedom}).",
    "rest": "Le misure sono spiegate senza alcun movimento. Scarto {misfit}, ammesso {allowed} (gradi di libertà: "
    "{freedom}).",
    "several": "Le misure sono spiegate ugualmente da {count} cause, dalla più semplice: {causes}.",
    "none": "Nessuna scelta di movimenti spiega le misure (al più {most} insieme). La più vicina è {cause}: scarto "
    "{misfit}, ammesso {allowed}; la più lontana è '{worst}', di {away} errori.",
    "none_at_all": "Nessuna scelta di movimenti spiega le misure (al più {most} insieme), e nessuna è stata calcolata.",
    "doubt": "Senza la misura '{name}', le altre sono spiegate da {cause}; è stata misurata {measured}, il valore "
    "previsto è {predicted} (a {away} scarti tipo). {mistake}",
    "mistake_sign": "Forse il segno è errato.",
    "mistake_unit": "Forse l'unità è errata: il valore moltiplicato per {factor} è compatibile.",
    "mistake_place": "Forse il luogo è errato: il valore è compatibile con il giunto {place}.",
    "mistake_unknown": "Nessun errore di segno, unità o luogo lo spiega.",
    "motion": "'{name}' di {motion} (da {low} a {high})",
    "motion_open": "'{name}' di {motion} (non determinato)",
    "nothing": "nessun movimento",
    "and": " e ",
    "or": "; oppure ",
    "stands": "In quella posizione è in equilibrio, in grandi spostamenti, e il movimento può crescere ancora di "
    "{left} prima che non si trovi più equilibrio.",
    "stands_far": "In quella posizione è in equilibrio, in grandi spostamenti, e lo è ancora a {times} volte il "
    "movimento.",
    "stands_not": "In grandi spostamenti non si è trovato equilibrio oltre {share} di questo movimento.",
    "stands_small": "In quella posizione è in equilibrio, in piccoli spostamenti.",
    "stands_rest": "È in equilibrio così com'è.",
    "another": "Un altro centimetro porta l'apertura del giunto più aperto da {now} a {then}.",
    "another_fails": "Con un altro centimetro non si trova equilibrio in grandi spostamenti.",
    "next": "Prossime misure: {places}.",
    "place_opening": "apertura di {joint} in ({at})",
    "place_slip": "scorrimento di {joint} in ({at})",
    "place_level": "quota di {joint} in ({at})",
    "place_displacement": "spostamento di {joint} in ({at}) lungo {axis}",
    "predicted": "{place}, dove le cause prevedono {values}",
    "spread": "{place}, prevista entro {spread}",
    "proof": "Certificato: equilibrio, distanze, cono d'attrito e direzione di scorrimento del modello in ogni stato "
    "del percorso di cedimento fino a ciascuna causa, entro {worst} (relativo; ammesso {allowed}). {tried} scelte di "
    "movimenti, {runs} percorsi di cedimento.",
    "proof_large": " In grandi spostamenti l'ultimo stato entro {residual}.",
    "meaning": "Una causa è un movimento di appoggi, o una variazione di carichi, dopo il quale il modello è in "
    "equilibrio e mostra quanto misurato entro gli errori. È una fra le possibilità date: ciò che non è fra queste "
    "non è stato considerato.",
    "unseen": "non determinato da queste misure: {motions} le cambia di {change} errori in tutto",
    "unseen_part": "'{name}' di {motion}",
    "addition": "Meno semplice, ma nettamente migliore: {motions}; lo scarto è allora {misfit}.",
    "coarse": "con passi più fini una lettura della causa più semplice cambia di {change} errori: servono più passi",
    "orders": "se i movimenti avvengono uno dopo l'altro anziché insieme, una lettura cambia di {change} errori",
    "together": "si assume che i movimenti siano cresciuti insieme, dopo tutti i carichi: un'altra storia può "
    "fessurare diversamente",
    "sparse": "cause con più movimenti di {size} non sono state considerate",
    "left": "{count} scelte di movimenti sono state lasciate dopo uno stato, lontano oltre {far} volte il consentito",
    "left_one": "una scelta di movimenti è stata lasciata dopo uno stato, lontano oltre {far} volte il consentito",
    "lent": "ai giunti rigidi tra conci rigidi è stata data una cedevolezza di {size} m/kN: senza di essa le loro "
    "forze non sono determinate",
    "forced": "conci che non possono cedere sono forzati insieme: i giunti si chiudono fino a {closing}, {change} "
    "errori, per la cedevolezza che è stata loro data, e la risposta vale per quella cedevolezza",
    "local": "ogni scelta è adattata da pochi punti di partenza: una causa lontana da tutti può essere sfuggita",
    "rivals": "una causa più semplice spiegherebbe tutto tranne '{name}': {cause}. {mistake}",
    "small": "nei percorsi di cedimento da cui si trovano le cause gli spostamenti sono considerati piccoli",
    "unchecked_lost": "{count} scelte di movimenti, che non si sono potute seguire",
    "unchecked_lost_one": "una scelta di movimenti, che non si è potuta seguire",
    "unchecked_large": "se sta in equilibrio in grandi spostamenti",
    "unchecked_began": "se sta in equilibrio in grandi spostamenti: non vi si è trovato equilibrio neppure prima di "
    "ogni movimento",
    "unchecked_tests": "se questa causa è falsa: le misure sono tante quanti i movimenti",
    "step_measure": "Misurare dove le cause differiscono di più, e ripetere la diagnosi.",
    "step_doubt": "Ripetere la misura dubbia.",
    "step_candidates": "Cercare che cos'altro può essersi mosso o cambiato, e aggiungerlo alle possibilità.",
    "step_forced": "Dare una rigidezza ai giunti o ai conci, oppure limitare i movimenti con low e high.",
    "step_watch": "Tenere sotto osservazione la fessura più aperta: una causa conclusa non cresce.",
    "number": "una variazione di {value} del suo fattore",
    "unlimited": "illimitato",
}
WORDS: Mapping[str, Mapping[str, str]] = {"en": EN, "it": IT}
"""Words by language."""
