/* Made by `make bindings` from the header of Ipopt 3.14. */
#include <IpStdCInterface.h>
typedef double ipnumber;
typedef int ipindex;
__attribute__ ((deprecated)) typedef ipindex ipfint;
__attribute__ ((deprecated)) typedef ipnumber Number;
__attribute__ ((deprecated)) typedef int Index;
__attribute__ ((deprecated)) typedef int Int;
typedef struct IpoptProblemInfo* IpoptProblem;
typedef _Bool Bool;
typedef void* UserDataPtr;
typedef _Bool (*Eval_F_CB)( ipindex n, ipnumber* x, _Bool new_x, ipnumber* obj_value, UserDataPtr user_data );
typedef _Bool (*Eval_Grad_F_CB)( ipindex n, ipnumber* x, _Bool new_x, ipnumber* grad_f, UserDataPtr user_data );
typedef _Bool (*Eval_G_CB)( ipindex n, ipnumber* x, _Bool new_x, ipindex m, ipnumber* g, UserDataPtr user_data );
typedef _Bool (*Eval_Jac_G_CB)( ipindex n, ipnumber* x, _Bool new_x, ipindex m, ipindex nele_jac, ipindex* iRow, ipindex* jCol, ipnumber* values, UserDataPtr user_data );
typedef _Bool (*Eval_H_CB)( ipindex n, ipnumber* x, _Bool new_x, ipnumber obj_factor, ipindex m, ipnumber* lambda, _Bool new_lambda, ipindex nele_hess, ipindex* iRow, ipindex* jCol, ipnumber* values, UserDataPtr user_data );
typedef _Bool (*Intermediate_CB)( ipindex alg_mod, ipindex iter_count, ipnumber obj_value, ipnumber inf_pr, ipnumber inf_du, ipnumber mu, ipnumber d_norm, ipnumber regularization_size, ipnumber alpha_du, ipnumber alpha_pr, ipindex ls_trials, UserDataPtr user_data );
IpoptProblem CreateIpoptProblem( ipindex n, ipnumber* x_L, ipnumber* x_U, ipindex m, ipnumber* g_L, ipnumber* g_U, ipindex nele_jac, ipindex nele_hess, ipindex index_style, Eval_F_CB eval_f, Eval_G_CB eval_g, Eval_Grad_F_CB eval_grad_f, Eval_Jac_G_CB eval_jac_g, Eval_H_CB eval_h );
void FreeIpoptProblem( IpoptProblem ipopt_problem );
_Bool AddIpoptStrOption( IpoptProblem ipopt_problem, char* keyword, char* val );
_Bool AddIpoptNumOption( IpoptProblem ipopt_problem, char* keyword, ipnumber val );
_Bool AddIpoptIntOption( IpoptProblem ipopt_problem, char* keyword, ipindex val );
_Bool SetIntermediateCallback( IpoptProblem ipopt_problem, Intermediate_CB intermediate_cb );
enum ApplicationReturnStatus IpoptSolve( IpoptProblem ipopt_problem, ipnumber* x, ipnumber* g, ipnumber* obj_val, ipnumber* mult_g, ipnumber* mult_x_L, ipnumber* mult_x_U, UserDataPtr user_data );
