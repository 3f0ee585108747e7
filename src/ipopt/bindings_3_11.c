/* Made by `make bindings` from the header of Ipopt 3.11. */
#include <IpStdCInterface.h>
typedef double Number;
typedef int Index;
typedef int Int;
typedef struct IpoptProblemInfo* IpoptProblem;
typedef int Bool;
typedef void * UserDataPtr;
typedef Bool (*Eval_F_CB)(Index n, Number* x, Bool new_x, Number* obj_value, UserDataPtr user_data);
typedef Bool (*Eval_Grad_F_CB)(Index n, Number* x, Bool new_x, Number* grad_f, UserDataPtr user_data);
typedef Bool (*Eval_G_CB)(Index n, Number* x, Bool new_x, Index m, Number* g, UserDataPtr user_data);
typedef Bool (*Eval_Jac_G_CB)(Index n, Number *x, Bool new_x, Index m, Index nele_jac, Index *iRow, Index *jCol, Number *values, UserDataPtr user_data);
typedef Bool (*Eval_H_CB)(Index n, Number *x, Bool new_x, Number obj_factor, Index m, Number *lambda, Bool new_lambda, Index nele_hess, Index *iRow, Index *jCol, Number *values, UserDataPtr user_data);
typedef Bool (*Intermediate_CB)(Index alg_mod, Index iter_count, Number obj_value, Number inf_pr, Number inf_du, Number mu, Number d_norm, Number regularization_size, Number alpha_du, Number alpha_pr, Index ls_trials, UserDataPtr user_data);
IpoptProblem CreateIpoptProblem( Index n , Number* x_L , Number* x_U , Index m , Number* g_L , Number* g_U , Index nele_jac , Index nele_hess , Index index_style , Eval_F_CB eval_f , Eval_G_CB eval_g , Eval_Grad_F_CB eval_grad_f , Eval_Jac_G_CB eval_jac_g , Eval_H_CB eval_h );
void FreeIpoptProblem(IpoptProblem ipopt_problem);
Bool AddIpoptStrOption(IpoptProblem ipopt_problem, char* keyword, char* val);
Bool AddIpoptNumOption(IpoptProblem ipopt_problem, char* keyword, Number val);
Bool AddIpoptIntOption(IpoptProblem ipopt_problem, char* keyword, Int val);
Bool SetIntermediateCallback(IpoptProblem ipopt_problem, Intermediate_CB intermediate_cb);
enum ApplicationReturnStatus IpoptSolve( IpoptProblem ipopt_problem , Number* x , Number* g , Number* obj_val , Number* mult_g , Number* mult_x_L , Number* mult_x_U , UserDataPtr user_data );
