!> Models behind integers, for callers that cannot hold a derived type.
module sla_handle
   use common_handles, only : handle_new, handle_take, handle_leave
   use common_lists, only : handle_sla
   use common_status, only : status_ok, status_bad_index, status_not_ready, status_out_of_memory
   use sla_group, only : element_group
   use sla_model, only : element_model, model_add, model_free
   use, intrinsic :: iso_c_binding, only : c_f_pointer, c_funloc, c_int, c_int64_t, c_loc, c_null_ptr, c_ptr
   implicit none
   private
   public :: model_register, model_destroy, model_take, group_begun, group_added, all_directions, check_nodes
   public :: stage_new, stage_prepared, stage_factored, stage_loaded

   !> How far a model is built: groups are added to a new one, loads need a factor, events need loads
   integer, parameter :: stage_new = 0, stage_prepared = 1, stage_factored = 2, stage_loaded = 3

contains

   !> Hand a model over to the registry
   subroutine model_register(model, handle, status)
      type(element_model), pointer, intent(inout) :: model    !! null after a failure
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      call handle_new(handle_sla, c_loc(model), c_funloc(model_destroy), handle, status)
      if (status /= status_ok) deallocate (model)
   end subroutine model_register

   !> Called by the registry
   subroutine model_destroy(object) bind(c, name='extrados_sla_destroy')
      type(c_ptr), value, intent(in) :: object
      type(element_model), pointer :: model
      call c_f_pointer(object, model)
      call model_free(model)
      deallocate (model)
   end subroutine model_destroy

   !> The model of a handle, for this call alone, until handle_leave; null where the status is not ok
   subroutine model_take(handle, least, most, model, status)
      integer(c_int64_t), intent(in) :: handle
      integer, intent(in) :: least                   !! stage_... it must have reached
      integer, intent(in) :: most                    !! stage_... it must not have passed
      type(element_model), pointer, intent(out) :: model
      integer(c_int), intent(out) :: status
      type(c_ptr) :: object
      model => null()
      object = c_null_ptr
      call handle_take(handle, handle_sla, .true., object, status)
      if (status /= status_ok) return
      call c_f_pointer(object, model)
      if (model%stage >= least .and. model%stage <= most) return
      status = status_not_ready
      model => null()
      call handle_leave(handle)
   end subroutine model_take

   !> Take a model to add a group to it, whose nodes and tooth tables are checked; group_added must follow where the
   !> status is ok
   subroutine group_begun(handle, connect, table, model, status)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: connect(:, :)    !! (nodes, elements), 1-based
      integer(c_int), intent(in) :: table(:, :)      !! tooth tables, 0 none
      type(element_model), pointer, intent(out) :: model
      integer(c_int), intent(out) :: status
      call model_take(handle, stage_new, stage_new, model, status)
      if (status /= status_ok) return
      call check_nodes(model, connect, 1_c_int, status)
      if (any(table < 0) .or. any(table > model%mesh%teeth%tables())) status = status_bad_index
      if (status /= status_ok) call handle_leave(handle)
   end subroutine group_begun

   !> Add a group that uses the first freedoms of its nodes, unless making it failed, and leave the model
   subroutine group_added(handle, model, connect, directions, group, status)
      integer(c_int64_t), intent(in) :: handle
      type(element_model), intent(inout) :: model
      integer(c_int), intent(in) :: connect(:, :)                    !! (nodes, elements), 1-based
      integer, intent(in) :: directions                              !! of a node
      class(element_group), allocatable, intent(inout) :: group      !! taken over
      integer(c_int), intent(inout) :: status                        !! of the group that was made
      integer(c_int), allocatable :: node(:, :), direction(:, :)
      if (status == status_ok) call all_directions(connect, directions, node, direction, status)
      if (status == status_ok) call model_add(model%mesh, group, node, direction, status)
      call handle_leave(handle)
   end subroutine group_added

   !> Do all entries name a node of the model?
   pure subroutine check_nodes(model, node, lowest, status)
      type(element_model), intent(in) :: model
      integer(c_int), intent(in) :: node(:, :)       !! 1-based
      integer(c_int), intent(in) :: lowest           !! 1, or 0 where 0 is the ground
      integer(c_int), intent(out) :: status
      status = merge(status_bad_index, status_ok, any(node < lowest) .or. any(node > model%mesh%nodes))
   end subroutine check_nodes

   !> Node and direction of each freedom of elements that use the first freedoms of their nodes
   subroutine all_directions(connect, directions, node, direction, status)
      integer(c_int), intent(in) :: connect(:, :)                    !! (nodes, elements)
      integer, intent(in) :: directions                              !! of a node
      integer(c_int), allocatable, intent(out) :: node(:, :)         !! (directions nodes, elements)
      integer(c_int), allocatable, intent(out) :: direction(:, :)
      integer(c_int), intent(out) :: status
      integer :: i, k, info
      allocate (node(directions * size(connect, 1), size(connect, 2)), &
         direction(directions * size(connect, 1), size(connect, 2)), stat=info)
      status = merge(status_ok, status_out_of_memory, info == 0)
      if (info /= 0) return
      do i = 1, size(connect, 1)
         do k = 1, directions
            node(directions * (i - 1) + k, :) = connect(i, :)
            direction(directions * (i - 1) + k, :) = int(k, c_int)
         end do
      end do
   end subroutine all_directions

end module sla_handle
